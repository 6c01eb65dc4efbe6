//! `pipeline profile`: renders a scene and prints what every system cost.

use crate::args::ProfileArgs;
use crate::exit::Failure;
use crate::profiling::Profiler;
use crate::run;
use crate::stages::short_path;
use crate::terminal::print;
use pipeline_core::{Counters, Profile};
use std::fmt::Write;

pub(crate) fn execute(options: &ProfileArgs) -> Result<(), Failure> {
    let profiler = Profiler::start(&options.render, true)?;
    let outputs = options.render.output.clone();
    let rendered = run::render(&options.scene, &options.render, outputs, profiler.as_ref())?;
    if let Some(profiler) = &profiler {
        let counters = rendered.app.world().resource::<Counters>();
        print(&tables(&profiler.profile, counters))?;
    }
    rendered.ended
}

fn tables(profile: &Profile, counters: &Counters) -> String {
    let mut text = profile.table(short_path);
    let width = counters.iter().map(|(name, _)| name.len()).max().unwrap_or(0).max(7);
    let _ = writeln!(text, "\n{:width$} {:>15}", "counter", "value");
    for (name, value) in counters.iter() {
        let _ = writeln!(text, "{name:width$} {value:>15}");
    }
    if let Some(bytes) = peak_memory() {
        let _ = writeln!(text, "\npeak memory {:.1} MiB", bytes as f64 / f64::from(1 << 20));
    }
    text
}

/// The most memory that this process held so far, in bytes, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    peak_in(&status)
}

fn peak_in(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peak_memory_is_read() {
        assert_eq!(peak_in("VmPeak:\t 99 kB\nVmHWM:\t    1234 kB\n"), Some(1234 * 1024));
        assert_eq!(peak_in("VmPeak:\t 99 kB\n"), None);
    }

    #[test]
    fn counters_stand_in_the_tables() {
        let mut counters = Counters::default();
        counters.counter("photon_map/photons stored").add(42);
        let text = tables(&Profile::new(false), &counters);
        assert!(text.contains("photon_map/photons stored              42\n"), "{text}");
    }
}
