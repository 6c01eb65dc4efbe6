//! The shape of the workspace: which crate may know which, stages that keep apart, schedules without ambiguity.

use bevy_app::App;
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::{IntoScheduleConfigs, Schedules};
use bevy_ecs::system::{Res, ResMut};
use pipeline_core::{CorePlugin, Finish, FinishSystems, describe_schedules};
use pipeline_stages::DefaultStages;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The crates of the workspace, each with all crates of the workspace that it may depend on.
const ARROWS: [(&str, &[&str]); 11] = [
    ("radiometry", &[]),
    ("scattering", &["radiometry"]),
    ("spatial", &["radiometry"]),
    ("film", &[]),
    ("texture", &["radiometry", "film"]),
    ("transport", &["scattering", "spatial", "texture", "radiometry"]),
    ("scene_format", &[]),
    ("pipeline_core", &[]),
    (
        "pipeline_data",
        &[
            "pipeline_core",
            "transport",
            "scattering",
            "spatial",
            "texture",
            "radiometry",
            "film",
            "scene_format",
        ],
    ),
    (
        "pipeline_stages",
        &[
            "pipeline_core",
            "pipeline_data",
            "transport",
            "scattering",
            "spatial",
            "texture",
            "radiometry",
            "film",
            "scene_format",
        ],
    ),
    (
        "pipeline",
        &[
            "pipeline_core",
            "pipeline_data",
            "pipeline_stages",
            "transport",
            "scattering",
            "spatial",
            "texture",
            "radiometry",
            "film",
            "scene_format",
        ],
    ),
];

/// A crate of the workspace with the names of what it depends on, be it for use, for tests or for building.
#[derive(Clone, Debug)]
struct Package {
    name: String,
    dependencies: Vec<String>,
}

/// Asks cargo for the crates of this workspace.
fn workspace_packages() -> Vec<Package> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON from cargo");
    let name = |value: &serde_json::Value| value["name"].as_str().expect("a name").to_owned();
    let packages = metadata["packages"].as_array().expect("packages").iter();
    let read = |package: &serde_json::Value| Package {
        name: name(package),
        dependencies: package["dependencies"]
            .as_array()
            .expect("dependencies")
            .iter()
            .map(name)
            .collect(),
    };
    packages.map(read).collect()
}

/// Lists dependencies that break the rules, as `from -> to`, and crates that no rule is known for.
fn forbidden_dependencies(packages: &[Package]) -> Vec<String> {
    let mut found = Vec::new();
    for package in packages {
        let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == package.name) else {
            found.push(format!("{} is not listed", package.name));
            continue;
        };
        let may_know_ecs = package.name.starts_with("pipeline");
        for dependency in &package.dependencies {
            let is_ours = ARROWS.iter().any(|(name, _)| name == dependency);
            let is_ecs = dependency.starts_with("bevy") && dependency != "bevy_reflect";
            if is_ours && !allowed.contains(&dependency.as_str()) || is_ecs && !may_know_ecs {
                found.push(format!("{} -> {dependency}", package.name));
            }
        }
    }
    found
}

#[test]
fn dependencies_point_one_way() {
    let packages = workspace_packages();
    let names: Vec<&str> = packages.iter().map(|package| package.name.as_str()).collect();
    for (name, _) in ARROWS {
        assert!(names.contains(&name), "{name} is gone: {names:?}");
    }
    assert_eq!(forbidden_dependencies(&packages), Vec::<String>::new());
    let stages = packages
        .iter()
        .find(|package| package.name == "pipeline_stages")
        .unwrap();
    assert!(stages.dependencies.iter().any(|name| name == "bevy_ecs"), "{stages:?}");
}

#[test]
fn dependencies_that_point_back_are_found() {
    let with = |name: &str, dependency: &str| {
        let mut packages = workspace_packages();
        let package = packages.iter_mut().find(|package| package.name == name).unwrap();
        package.dependencies.push(dependency.to_owned());
        forbidden_dependencies(&packages)
    };
    for (name, dependency) in [
        ("radiometry", "scattering"),
        ("scattering", "spatial"),
        ("film", "radiometry"),
        ("scene_format", "bevy_ecs"),
        ("transport", "bevy_app"),
        ("transport", "pipeline_data"),
        ("pipeline_core", "film"),
        ("pipeline_data", "pipeline_stages"),
        ("pipeline_stages", "pipeline"),
    ] {
        assert_eq!(with(name, dependency), [format!("{name} -> {dependency}")]);
    }
    let stranger = Package {
        name: "stranger".to_owned(),
        dependencies: Vec::new(),
    };
    assert_eq!(forbidden_dependencies(&[stranger]), ["stranger is not listed"]);
}

/// Splits Rust into words and single signs, without comments, strings and characters; `::` is one sign.
fn tokens(source: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let length = if first.is_alphanumeric() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        let skipped = skipped_length(rest, found.last().copied());
        if skipped == 0 && !first.is_whitespace() {
            found.push(&rest[..length]);
        }
        rest = &rest[skipped.max(length)..];
    }
    found
}

/// Length of the comment, string or character that `rest` begins with, or 0.
///
/// - `before`: the token before it; an `r` makes a string raw.
/// - Knows raw strings with at most one hash, and no comments inside comments.
fn skipped_length(rest: &str, before: Option<&str>) -> usize {
    let to = |end: &str, from: usize| rest[from..].find(end).map_or(rest.len(), |at| from + at + end.len());
    if rest.starts_with("//") {
        return to("\n", 2);
    }
    if rest.starts_with("/*") {
        return to("*/", 2);
    }
    if rest.starts_with("r#\"") {
        return to("\"#", 3);
    }
    if rest.starts_with("'\\") {
        return to("'", 3);
    }
    if rest.starts_with('\'') {
        // A character is closed right after it; a lifetime is not.
        let mut following = rest.char_indices().skip(2);
        return following.next().filter(|(_, c)| *c == '\'').map_or(0, |(at, _)| at + 1);
    }
    if rest.starts_with('"') {
        if matches!(before, Some("r" | "br")) {
            return to("\"", 1);
        }
        let mut is_escaped = false;
        let end = rest.char_indices().skip(1).find(|(_, c)| {
            let ends = *c == '"' && !is_escaped;
            is_escaped = *c == '\\' && !is_escaped;
            ends
        });
        return end.map_or(rest.len(), |(at, _)| at + 1);
    }
    0
}

/// What a path names next: one word, or each first word of a group in braces.
fn names_at<'a>(tokens: &[&'a str]) -> Vec<&'a str> {
    if tokens.first() != Some(&"{") {
        return tokens.first().copied().into_iter().collect();
    }
    let (mut names, mut depth, mut is_first) = (Vec::new(), 0, false);
    for token in tokens {
        match *token {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," => {}
            name if is_first => names.push(name),
            _ => {}
        }
        if depth == 0 {
            break;
        }
        is_first = depth == 1 && (*token == "," || *token == "{");
    }
    names
}

/// Lists what a file reaches of the crate outside its own stage.
///
/// - `file`: path below `src`, such as `load/spawn.rs`.
/// - Tests may name `DefaultStages` besides.
fn reached_outside(file: &str, source: &str) -> Vec<String> {
    let parts: Vec<&str> = file
        .trim_end_matches(".rs")
        .split('/')
        .filter(|part| *part != "mod")
        .collect();
    let is_test = parts.contains(&"tests");
    let tokens = tokens(source);
    let mut found = Vec::new();
    // For each open brace, whether it opened a module.
    let mut braces = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let supers = tokens[at..]
            .chunks(2)
            .take_while(|pair| *pair == ["super", "::"])
            .count();
        let inner = braces.iter().filter(|is_module| **is_module).count();
        match tokens[at] {
            "{" => braces.push(at >= 2 && tokens[at - 2] == "mod"),
            "}" => drop(braces.pop()),
            _ => {}
        }
        let is_root = tokens[at] == "crate" && tokens.get(at + 1).is_some_and(|next| *next != ")")
            || supers >= parts.len() + inner;
        if is_root {
            let names = names_at(&tokens[(at + 2 * supers.max(1)).min(tokens.len())..]);
            let is_fine = |name: &str| name == parts[0] || is_test && name == "DefaultStages";
            found.extend(
                names
                    .into_iter()
                    .filter(|name| !is_fine(name))
                    .map(|name| format!("{file}: {name}")),
            );
        }
        at += (2 * supers).max(1);
    }
    found
}

/// All Rust files below a folder, sorted.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn stages_know_nothing_of_each_other() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/pipeline_stages/src");
    let mut found = Vec::new();
    let mut stages = Vec::new();
    for path in rust_files(&folder) {
        let file = path.strip_prefix(&folder).unwrap().to_str().unwrap().replace('\\', "/");
        if file == "lib.rs" {
            continue;
        }
        found.extend(reached_outside(&file, &fs::read_to_string(&path).unwrap()));
        stages.extend(
            file.strip_suffix("/mod.rs")
                .filter(|stage| !stage.contains('/'))
                .map(str::to_owned),
        );
    }
    assert_eq!(found, Vec::<String>::new());
    let declared = fs::read_to_string(folder.join("lib.rs")).unwrap();
    let declared: Vec<&str> = declared
        .lines()
        .filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'))
        .collect();
    assert!(declared.len() > 5, "{declared:?}");
    assert_eq!(stages, declared, "every stage is a directory");
}

#[test]
fn stages_that_know_each_other_are_found() {
    let reached = |file: &str, source: &str| reached_outside(file, source).len();
    for offence in [
        "use crate::camera::CameraSystems;",
        "use crate::{load::{LoadPlugin, camera}, camera};",
        "fn f() { crate::camera::g(); }",
        "use super::super::camera;",
        "use super::super::{camera::CameraSystems, load};",
        "use crate::*;",
        "use crate as root;",
        "use crate::DefaultStages;",
        "mod inner { use super::super::super::camera; }",
        "mod inner {} use super::super::camera;",
        "const C: char = '\"'; use crate::camera; const D: char = '\"';",
        "const S: &str = \"\\\"\"; use crate::camera; const T: &str = \"\";",
        "fn f<'a>() {} use crate::camera; fn g<'a>() {}",
    ] {
        assert_eq!(reached("load/spawn.rs", offence), 1, "{offence}");
    }
    for fine in [
        "use crate::load::LoadPlugin; pub(crate) fn f() {}",
        "use super::camera; mod tests { use super::super::camera; }",
        "use super::super::load;",
        "/// See [`crate::camera`].\n// crate::camera\n/* crate::camera */ fn f() {}",
        "const S: &str = \"crate::camera\"; const R: &str = r#\"\"crate::camera\"#;",
        "use crate::load::{self, camera};",
    ] {
        assert_eq!(reached("load/spawn.rs", fine), 0, "{fine}");
    }
    assert_eq!(reached("load/mod.rs", "use super::camera;"), 1);
    assert_eq!(reached("load/tests/mod.rs", "use super::super::camera;"), 1);
    assert_eq!(reached("load/tests/names.rs", "use super::super::super::camera;"), 1);
    assert_eq!(reached("load/tests.rs", "use crate::{DefaultStages, camera};"), 1);
    assert_eq!(reached("load/tests.rs", "use crate::DefaultStages;"), 0);
}

/// What bevy puts between systems by itself, so that what one spawned is there for the next.
const SYNC_POINT: &str = "bevy_ecs::apply_deferred";

/// The schedule that every bevy app is born with; nothing runs it here.
const BEVYS_OWN: &str = "First";

fn app() -> App {
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    app
}

/// Systems that stand in no named set, as `schedule: system`.
fn homeless_systems(app: &mut App) -> Vec<String> {
    let schedules = describe_schedules(app).expect("schedules without ambiguity");
    let mut found = Vec::new();
    for schedule in &schedules {
        let outside = schedule.sets.iter().filter(|set| set.name.is_empty());
        let systems = outside.flat_map(|set| &set.systems).filter(|name| *name != SYNC_POINT);
        found.extend(systems.map(|system| format!("{}: {system}", schedule.name)));
    }
    found
}

#[test]
fn schedules_have_an_order_and_every_system_a_set() {
    let mut app = app();
    let described = describe_schedules(&mut app).unwrap();
    for schedule in &described {
        let mut named = schedule.sets.iter().filter(|set| !set.name.is_empty());
        assert!(
            named.any(|set| !set.systems.is_empty()),
            "{} does nothing",
            schedule.name
        );
    }
    for (label, _) in app.world().resource::<Schedules>().iter() {
        let name = format!("{label:?}");
        let is_described = described.iter().any(|schedule| schedule.name == name);
        assert!(is_described || name == BEVYS_OWN, "{name} was not looked at");
    }
    assert_eq!(homeless_systems(&mut app), Vec::<String>::new());
}

#[derive(Resource, Default)]
struct Tally;

fn change_tally(_: ResMut<Tally>) {}

fn read_tally(_: Res<Tally>) {}

#[test]
fn ambiguities_and_systems_without_a_set_are_found() {
    let mut ambiguous = app();
    ambiguous.init_resource::<Tally>();
    ambiguous.add_systems(Finish, (change_tally, read_tally).in_set(FinishSystems::Write));
    let refusal = describe_schedules(&mut ambiguous).unwrap_err();
    assert!(
        refusal.starts_with("schedule Finish cannot be built") && refusal.contains("conflicting"),
        "{refusal}"
    );
    let mut outside = app();
    outside.init_resource::<Tally>();
    outside.add_systems(Finish, change_tally);
    let homeless = homeless_systems(&mut outside);
    assert_eq!(homeless, ["Finish: architecture::change_tally"]);
}
