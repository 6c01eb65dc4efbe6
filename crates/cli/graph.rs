//! Schedules as a Graphviz graph.

use crate::stages::short_path;
use pipeline_core::ScheduleDescription;
use std::fmt::Write;

/// A cluster for each schedule, a box for each set with its systems, arrows in the order they run.
pub(crate) fn dot(schedules: &[ScheduleDescription]) -> String {
    let mut text = String::from("digraph stages {\n    rankdir=LR;\n    node [shape=box, fontname=\"monospace\"];\n");
    for (row, schedule) in schedules.iter().enumerate() {
        let _ = writeln!(text, "    subgraph cluster_{row} {{");
        let _ = writeln!(text, "        label={};", quoted(&schedule.name));
        for (column, set) in schedule.sets.iter().enumerate() {
            let mut label = quoted(&format!("{}\n", set.name));
            label.pop();
            for system in &set.systems {
                label.push_str(&escaped(&short_path(system)));
                label.push_str("\\l");
            }
            let _ = writeln!(text, "        s{row}_{column} [label={label}\"];");
        }
        let nodes: Vec<String> = (0..schedule.sets.len())
            .map(|column| format!("s{row}_{column}"))
            .collect();
        if nodes.len() > 1 {
            let _ = writeln!(text, "        {};", nodes.join(" -> "));
        }
        text.push_str("    }\n");
    }
    text.push_str("}\n");
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use pipeline_core::SetDescription;

    #[test]
    fn sets_are_nodes_in_order() {
        let set = |name: &str, systems: &[&str]| SetDescription {
            name: name.into(),
            systems: systems.iter().map(|&system| system.into()).collect(),
        };
        let text = dot(&[ScheduleDescription {
            name: "Load".into(),
            sets: vec![set("Compose", &["a::b::c", "a::d"]), set("Spawn", &[])],
        }]);
        assert!(text.contains(r#"s0_0 [label="Compose\na::c\la::d\l"];"#), "{text}");
        assert!(text.contains(r#"s0_1 [label="Spawn\n"];"#), "{text}");
        assert!(text.contains("s0_0 -> s0_1;"), "{text}");
        assert_eq!(text.matches('{').count(), text.matches('}').count());
    }
}
