use std::cell::Cell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Time, calls and items of every system, gathered by [`ProfileLayer`](crate::ProfileLayer).
///
/// Times are of the system itself: what a system spends in systems that it runs counts as theirs.
#[derive(Clone, Debug, Default)]
pub struct Profile(Arc<Mutex<Recorded>>);

#[derive(Debug, Default)]
pub(crate) struct Recorded {
    rows: BTreeMap<String, SystemRow>,
    /// Calls in the order they began, for the trace file; empty unless asked for.
    events: Vec<TraceEvent>,
    pub(crate) keep_events: bool,
    dropped_events: u64,
}

/// What one system cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystemRow {
    /// How often it ran.
    pub calls: u64,
    /// Time by the wall clock.
    pub wall: Duration,
    /// Time of all processors, this process, while it ran.
    pub cpu: Duration,
    /// Items that it says it worked on; see [`record_items`].
    pub items: u64,
}

/// One call of one system, for a timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceEvent {
    /// Path of the system.
    pub name: String,
    /// Since the start of the program.
    pub start: Duration,
    /// Time by the wall clock, systems that it ran included.
    pub wall: Duration,
    /// Items that it says it worked on.
    pub items: u64,
}

/// More calls than this are not kept for the timeline: about 100 MB of file.
const MAX_EVENTS: usize = 1_000_000;

thread_local! {
    static ITEMS: Cell<u64> = const { Cell::new(0) };
}

/// Says how many items (photons, paths, records) the running system has worked on; adds up within one call.
///
/// Called on the thread that runs the system. Costs nothing worth mentioning when nobody profiles.
pub fn record_items(n: usize) {
    ITEMS.with(|items| items.set(items.get() + n as u64));
}

/// Takes the items recorded on this thread since the last call.
pub(crate) fn take_items() -> u64 {
    ITEMS.with(|items| items.replace(0))
}

impl Profile {
    /// A profile that also keeps every call for a timeline when `keep_events`.
    #[must_use]
    pub fn new(keep_events: bool) -> Self {
        Self(Arc::new(Mutex::new(Recorded {
            keep_events,
            ..Recorded::default()
        })))
    }

    pub(crate) fn add(&self, event: TraceEvent, own_wall: Duration, own_cpu: Duration) {
        let mut recorded = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let row = match recorded.rows.get_mut(&event.name) {
            Some(row) => row,
            None => recorded.rows.entry(event.name.clone()).or_default(),
        };
        row.calls += 1;
        row.wall += own_wall;
        row.cpu += own_cpu;
        row.items += event.items;
        if recorded.keep_events {
            if recorded.events.len() < MAX_EVENTS {
                recorded.events.push(event);
            } else {
                recorded.dropped_events += 1;
            }
        }
    }

    /// Every system with its cost, the dearest first; ties by name.
    #[must_use]
    pub fn rows(&self) -> Vec<(String, SystemRow)> {
        let recorded = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut rows: Vec<_> = recorded
            .rows
            .iter()
            .map(|(name, row)| (name.clone(), row.clone()))
            .collect();
        rows.sort_by(|a, b| b.1.wall.cmp(&a.1.wall).then_with(|| a.0.cmp(&b.0)));
        rows
    }

    /// A table for people: system, calls, total, share, items, time per item, threads busy.
    ///
    /// - `short`: the name to show for the path of a system.
    #[must_use]
    pub fn table(&self, short: impl Fn(&str) -> String) -> String {
        let rows: Vec<_> = self.rows().into_iter().map(|(path, row)| (short(&path), row)).collect();
        let total: Duration = rows.iter().map(|(_, row)| row.wall).sum();
        let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max(6);
        let mut out = format!(
            "{:width$} {:>9} {:>11} {:>7} {:>13} {:>10} {:>8}\n",
            "system", "calls", "total", "share", "items", "per item", "threads"
        );
        for (name, row) in &rows {
            let seconds = row.wall.as_secs_f64();
            let share = 100.0 * seconds / total.as_secs_f64().max(f64::MIN_POSITIVE);
            let (items, per_item) = if row.items == 0 {
                ("-".into(), "-".into())
            } else {
                (
                    row.items.to_string(),
                    format!("{:.1} ns", seconds * 1e9 / row.items as f64),
                )
            };
            // Processor time has a resolution of about a microsecond: shorter calls have no meaningful quotient.
            let busy = if seconds / row.calls as f64 > 1e-4 {
                format!("{:.2}", row.cpu.as_secs_f64() / seconds)
            } else {
                "-".into()
            };
            let _ = writeln!(
                out,
                "{:width$} {:>9} {:>8.3} ms {:>5.1} % {:>13} {:>10} {:>8}",
                name,
                row.calls,
                seconds * 1e3,
                share,
                items,
                per_item,
                busy
            );
        }
        let _ = writeln!(
            out,
            "{:width$} {:>9} {:>8.3} ms",
            "all systems",
            "",
            total.as_secs_f64() * 1e3
        );
        out
    }

    /// The table as JSON: a list of objects with `system`, `calls`, `seconds`, `cpu_seconds` and `items`.
    #[must_use]
    pub fn json(&self) -> String {
        let rows: Vec<_> = self
            .rows()
            .iter()
            .map(|(name, row)| {
                serde_json::json!({
                    "system": name, "calls": row.calls, "seconds": row.wall.as_secs_f64(),
                    "cpu_seconds": row.cpu.as_secs_f64(), "items": row.items,
                })
            })
            .collect();
        format!("{:#}\n", serde_json::Value::from(rows))
    }

    /// The timeline in the Trace Event Format, which Perfetto and `chrome://tracing` open.
    ///
    /// - `short`: the name to show for the path of a system.
    #[must_use]
    pub fn trace_json(&self, short: impl Fn(&str) -> String) -> String {
        let recorded = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut out = String::from("{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n");
        for (i, event) in recorded.events.iter().enumerate() {
            let entry = serde_json::json!({
                "name": short(&event.name), "cat": "system", "ph": "X", "pid": 1, "tid": 1,
                "ts": event.start.as_secs_f64() * 1e6, "dur": event.wall.as_secs_f64() * 1e6,
                "args": {"system": event.name, "items": event.items},
            });
            let _ = writeln!(out, "{entry}{}", if i + 1 < recorded.events.len() { "," } else { "" });
        }
        let _ = write!(
            out,
            "],\"otherData\":{{\"calls left out\":{}}}}}",
            recorded.dropped_events
        );
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_add_up_and_are_sorted_by_cost() {
        let profile = Profile::new(true);
        let event = |name: &str, items| TraceEvent {
            name: name.into(),
            start: Duration::ZERO,
            wall: Duration::from_millis(2),
            items,
        };
        for _ in 0..3 {
            profile.add(event("a::cheap", 0), Duration::from_millis(1), Duration::from_millis(1));
            profile.add(
                event("stage::file::dear<x::Y>", 10),
                Duration::from_millis(2),
                Duration::from_millis(4),
            );
        }
        let rows = profile.rows();
        assert_eq!(rows[0].0, "stage::file::dear<x::Y>");
        assert_eq!((rows[0].1.calls, rows[0].1.items), (3, 30));
        let last = |path: &str| path.rsplit_once("file::").map_or(path, |(_, name)| name).to_owned();
        assert!(profile.table(last).contains("\ndear<x::Y>  "));
        let trace: serde_json::Value = serde_json::from_str(&profile.trace_json(last)).expect("valid JSON");
        assert_eq!(trace["traceEvents"].as_array().map(Vec::len), Some(6));
        assert!(serde_json::from_str::<serde_json::Value>(&profile.json()).is_ok());
    }
}
