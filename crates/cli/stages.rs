//! `pipeline stages`: schedules, sets and systems in the order they run.

use crate::args::StagesArgs;
use crate::exit::Failure;
use crate::graph;
use crate::session;
use crate::terminal::{print, use_colour};
use pipeline_core::{ScheduleDescription, describe_schedules};
use pipeline_data::RenderRequest;
use std::fmt::Write;

pub(crate) fn execute(options: &StagesArgs) -> Result<(), Failure> {
    let mut app = match &options.scene {
        None => session::new_app(),
        Some(scene) => session::check(RenderRequest {
            scene: scene.clone(),
            colour: use_colour(),
            ..RenderRequest::default()
        })?,
    };
    let schedules = without_sync_points(describe_schedules(&mut app).map_err(Failure::failed)?);
    print(&if options.dot {
        graph::dot(&schedules)
    } else {
        tree(&schedules)
    })
}

/// Leaves out where bevy applies commands between two systems: that is no work of a stage.
fn without_sync_points(mut schedules: Vec<ScheduleDescription>) -> Vec<ScheduleDescription> {
    for schedule in &mut schedules {
        for set in &mut schedule.sets {
            set.systems.retain(|system| !system.ends_with("::apply_deferred"));
        }
        schedule
            .sets
            .retain(|set| !set.name.is_empty() || !set.systems.is_empty());
    }
    schedules
}

fn tree(schedules: &[ScheduleDescription]) -> String {
    let mut text = String::new();
    for schedule in schedules {
        let _ = writeln!(text, "{}", schedule.name);
        for set in &schedule.sets {
            let name = if set.name.is_empty() { "(in no set)" } else { &set.name };
            let _ = writeln!(text, "  {name}");
            for system in &set.systems {
                let _ = writeln!(text, "    {}", short_path(system));
            }
        }
    }
    text
}

/// The crate that holds the renderer's own stages; their names are enough.
const OWN: &str = "pipeline_stages::";

/// `stage::system` for the path of a system: without the files in between, and type arguments by their last name.
pub(crate) fn short_path(path: &str) -> String {
    let (head, arguments) = match path.split_once('<') {
        Some((head, rest)) => (head, rest.trim_end_matches('>')),
        None => (path, ""),
    };
    let head = head.strip_prefix(OWN).unwrap_or(head);
    let mut short = match (head.split_once("::"), head.rsplit_once("::")) {
        (Some((stage, _)), Some((_, system))) => format!("{stage}::{system}"),
        _ => head.to_owned(),
    };
    if !arguments.is_empty() {
        let names: Vec<&str> = arguments
            .split(", ")
            .map(|argument| argument.rsplit("::").next().unwrap_or(argument))
            .collect();
        let _ = write!(short, "<{}>", names.join(", "));
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_core::SetDescription;

    #[test]
    fn paths_are_cut_to_stage_and_system() {
        assert_eq!(
            short_path("pipeline_stages::load::compose::compose_scene"),
            "load::compose_scene"
        );
        assert_eq!(
            short_path("pipeline_core::driver::trace_paths"),
            "pipeline_core::trace_paths"
        );
        assert_eq!(short_path("a::b::spawn<c::d::Sphere, e::F>"), "a::spawn<Sphere, F>");
        assert_eq!(short_path("alone"), "alone");
    }

    #[test]
    fn sync_points_are_left_out() {
        let set = |name: &str, systems: &[&str]| SetDescription {
            name: name.into(),
            systems: systems.iter().map(|&system| system.into()).collect(),
        };
        let sync = "bevy_ecs::schedule::executor::apply_deferred";
        let schedules = without_sync_points(vec![ScheduleDescription {
            name: "Load".into(),
            sets: vec![set("Compose", &["a::b", sync]), set("Spawn", &[]), set("", &[sync])],
        }]);
        assert_eq!(schedules[0].sets, [set("Compose", &["a::b"]), set("Spawn", &[])]);
    }

    #[test]
    fn trees_are_indented() {
        let schedules = [ScheduleDescription {
            name: "Load".into(),
            sets: vec![
                SetDescription {
                    name: "Compose".into(),
                    systems: vec!["pipeline_stages::load::compose::compose_scene".into()],
                },
                SetDescription {
                    name: String::new(),
                    systems: vec!["extra::count".into()],
                },
            ],
        }];
        let expected = "Load\n  Compose\n    load::compose_scene\n  (in no set)\n    extra::count\n";
        assert_eq!(tree(&schedules), expected);
    }
}
