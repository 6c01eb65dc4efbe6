//! Cases with changes at random: an answer within the limits, no panic, no hang.

use proptest::prelude::*;
use scene_format::{Limits, Options, Schema, errors_json, flatten_json, flatten_ron, load};
use serde_json::Value;

use crate::vocabulary;

fn cases() -> Vec<Vec<(String, String)>> {
    let lines = include_str!("named.jsonl").lines().chain(include_str!("public.jsonl").lines());
    lines
        .map(|line| {
            let case: Value = serde_json::from_str(line).unwrap();
            let root = format!("{}.ron", case["root"].as_str().unwrap());
            let files = case["ron"].as_object().unwrap();
            let mut files: Vec<(String, String)> = files
                .iter()
                .map(|(name, text)| (name.clone(), text.as_str().unwrap().to_owned()))
                .collect();
            // The root comes first.
            files.sort_by_key(|(name, _)| *name != root);
            files
        })
        .collect()
}

/// Composes files, the first as the root, and writes the result in every form.
fn survives(files: &[(String, Vec<u8>)]) {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    let registry = vocabulary::registry();
    let schema = Schema::new(&registry, vocabulary::is_component).unwrap();
    let options = Options {
        check_targets: false,
        limits: Limits {
            index_nodes: 5_000,
            ..Limits::default()
        },
        ..Options::default()
    };
    match load(&folder.path().join(&files[0].0), &schema, &options) {
        Ok(scene) => assert!(flatten_json(&scene).len() + flatten_ron(&scene).len() > 0),
        Err(refusal) => assert!(errors_json(&refusal).contains("error") && refusal.render(true).contains("error")),
    }
}

/// Where the quoted texts of a file are, without the quotes.
fn quoted(text: &str) -> Vec<(usize, usize)> {
    let quotes: Vec<usize> = text.match_indices('"').map(|(at, _)| at).collect();
    quotes.chunks_exact(2).map(|pair| (pair[0] + 1, pair[1])).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(600) })]

    #[test]
    fn changed_bytes(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<u8>(), 0..3_u8), 1..6),
    ) {
        let cases = cases();
        let mut files: Vec<(String, Vec<u8>)> =
            which.get(&cases).iter().map(|(name, text)| (name.clone(), text.clone().into_bytes())).collect();
        for (file, at, byte, kind) in changes {
            let number = file.index(files.len());
            let bytes = &mut files[number].1;
            if bytes.is_empty() { continue; }
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => { bytes.remove(at); }
                _ => bytes.insert(at, byte),
            }
        }
        survives(&files);
    }

    /// Names, paths, files and variants take each other's places: circles, wrong kinds, deep chains.
    #[test]
    fn changed_graphs(
        which in any::<prop::sample::Index>(),
        swaps in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any::<prop::sample::Index>()), 1..8),
    ) {
        let cases = cases();
        let mut files = which.get(&cases).clone();
        let words: Vec<String> = files
            .iter()
            .flat_map(|(_, text)| quoted(text).into_iter().map(|(from, to)| text[from..to].to_owned()))
            .collect();
        for (file, at, word) in swaps {
            let number = file.index(files.len());
            let text = &mut files[number].1;
            let places = quoted(text);
            if places.is_empty() || words.is_empty() { continue; }
            let (from, to) = places[at.index(places.len())];
            text.replace_range(from..to, word.get(&words));
        }
        let files: Vec<(String, Vec<u8>)> = files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect();
        survives(&files);
    }
}
