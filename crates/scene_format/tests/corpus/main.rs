//! Cases that another implementation composed: 98 that isolate a rule each, 100 at random.
//!
//! A line of `named.jsonl` and `public.jsonl` is a case: the files, the arguments, and the answer as
//! [`flatten_json`] gives it, places of opinions included, or the code of the error.

mod mutations;
mod vocabulary;

use scene_format::{Options, Schema, errors_json, flatten_json, load};
use serde_json::{Map, Value, json};

/// Numbers may differ by this share: the other implementation rounds to nine digits.
const TOLERANCE: f64 = 1e-6;

fn options(case: &Value) -> Options {
    let mut options = Options {
        check_targets: false,
        ..Options::default()
    };
    let arguments = case["args"].as_array().cloned().unwrap_or_default();
    let mut arguments = arguments.iter().filter_map(Value::as_str);
    while let Some(argument) = arguments.next() {
        match argument {
            "--variant" => options.variants.extend(arguments.next().map(str::to_owned)),
            "--set" => options.sets.extend(arguments.next().map(str::to_owned)),
            "--no-payloads" => options.load_payloads = false,
            other => panic!("unknown argument {other}"),
        }
    }
    options
}

fn compose(case: &Value) -> Value {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in case["ron"].as_object().unwrap() {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text.as_str().unwrap()).unwrap();
    }
    let registry = vocabulary::registry();
    let schema = Schema::new(&registry, vocabulary::is_component).unwrap();
    let root = folder.path().join(format!("{}.ron", case["root"].as_str().unwrap()));
    let answer = match load(&root, &schema, &options(case)) {
        Ok(scene) => flatten_json(&scene),
        Err(refusal) => errors_json(&refusal),
    };
    let answer = answer.replace(&format!("{}/", folder.path().display()), "");
    serde_json::from_str(&answer).unwrap()
}

/// Says where two answers differ.
fn difference(expected: &Value, got: &Value, at: &str) -> Option<String> {
    let differs = || Some(format!("{at}: {got}, expected {expected}"));
    match (expected, got) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64()?, b.as_f64()?);
            let close = (a - b).abs() <= TOLERANCE * a.abs().max(b.abs()).max(1.0);
            if close { None } else { differs() }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(number, (a, b))| difference(a, b, &format!("{at}[{number}]")))
        }
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => a
            .iter()
            .find_map(|(key, a)| difference(a, &b[key], &format!("{at}.{key}"))),
        (a, b) if a == b => None,
        _ => differs(),
    }
}

/// Leaves out what is empty, as the answers of the other implementation do.
fn without_empty(prim: &Value) -> Value {
    let is_empty =
        |value: &Value| value.as_array().is_some_and(Vec::is_empty) || value.as_object().is_some_and(Map::is_empty);
    let fields = prim.as_object().unwrap().iter().filter(|(_, value)| !is_empty(value));
    Value::Object(fields.map(|(key, value)| (key.clone(), value.clone())).collect())
}

fn judge(case: &Value) -> Option<String> {
    let (expected, got) = (&case["expected"], compose(case));
    if expected["status"] != got["status"] {
        return Some(format!("{got}, expected {}", expected["status"]));
    }
    if expected["status"] == "ok" {
        let list = |answer: &Value| {
            answer["prims"]
                .as_array()
                .unwrap()
                .iter()
                .map(without_empty)
                .collect::<Value>()
        };
        return difference(&list(expected), &list(&got), "prims");
    }
    let errors = got["errors"].as_array().unwrap();
    let codes = expected["codes"].as_array().unwrap();
    let missing = codes
        .iter()
        .find(|&code| !errors.iter().any(|error| &error["code"] == code));
    if let Some(code) = missing {
        return Some(format!("{code} is not reported: {got}"));
    }
    let at = expected.get("at")?;
    let column = |value: &Value| value["col"].as_i64().unwrap();
    let found = errors.iter().any(|error| {
        error["code"] == codes[0]
            && error["file"] == at["file"]
            && error["line"] == at["line"]
            && (column(error) - column(at)).abs() <= 1
    });
    (!found).then(|| format!("{} is not at {at}: {got}", codes[0]))
}

fn run(cases: &str, count: usize) {
    let mut failures = Vec::new();
    let mut number = 0;
    for line in cases.lines() {
        let case: Value = serde_json::from_str(line).unwrap();
        number += 1;
        if let Some(why) = judge(&case) {
            failures.push(format!("{}: {why}", case["name"]));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert_eq!(number, count);
}

#[test]
fn named_cases() {
    run(include_str!("named.jsonl"), 98);
}

#[test]
fn random_cases() {
    run(include_str!("public.jsonl"), 100);
}

#[test]
fn a_difference_is_noticed() {
    let line = include_str!("named.jsonl").lines().next().unwrap();
    let mut case: Value = serde_json::from_str(line).unwrap();
    case["expected"]["prims"][0]["active"] = json!(false);
    assert!(judge(&case).is_some());
}
