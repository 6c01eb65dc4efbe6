//! An audit as text and as JSON.

use crate::args::AuditArgs;
use crate::audit::Judged;
use crate::number::number;
use film::{Audit, AuditTest};
use std::fmt::Write;
use transport::Layer;

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A few lines for people.
pub(crate) fn table(judged: &Judged, options: &AuditArgs) -> String {
    let audit = &judged.audit;
    let mut text = format!(
        "{} blocks of up to {side}x{side} pixels, {} samples a pixel by the scene's own methods, {} traced\n",
        judged.blocks.len(),
        audit.samples[0],
        audit.samples[1],
        side = options.block_size,
    );
    let _ = writeln!(
        text,
        "{:16} {:>11} {:>11} {:>11} {:>11} {:>9}",
        "mean",
        "ours",
        "traced",
        "difference",
        format!("± ({})", percent(options.confidence)),
        "p"
    );
    for test in &audit.overall {
        let margin = film::t_quantile(1.0 - options.confidence, test.freedom) * test.standard_error;
        let _ = writeln!(
            text,
            "{:16} {:>11} {:>11} {:>11} {:>11} {:>9}",
            name(test),
            number(test.ours),
            number(test.traced),
            signed_percent(test.relative_difference()),
            percent(margin / test.traced),
            chance(test)
        );
    }
    let worst = worst(audit, options.worst);
    if !worst.is_empty() {
        let _ = writeln!(
            text,
            "{:16} {:>11} {:>11} {:>11} {:>11} {:>9} {:>9}  layer",
            "worst blocks", "ours", "traced", "difference", "error", "t", "p"
        );
    }
    for test in worst {
        let _ = writeln!(
            text,
            "{:16} {:>11} {:>11} {:>11} {:>11} {:>9.2} {:>9}  {}",
            format!("  {}", place(judged, test)),
            number(test.ours),
            number(test.traced),
            signed_percent(test.relative_difference()),
            number(test.standard_error),
            test.t,
            chance(test),
            name(test)
        );
    }
    text + &verdict(audit, options)
}

/// The blocks that differ most beyond tolerance: by chance, then by t; those that decide nothing are left out.
fn worst(audit: &Audit, count: usize) -> Vec<&AuditTest> {
    let mut tests: Vec<&AuditTest> = audit.blocks.iter().filter(|test| test.t != 0.0).collect();
    tests.retain(|test| test.chance.is_some());
    tests.sort_by(|a, b| {
        let by_chance = a.chance.unwrap_or(1.0).total_cmp(&b.chance.unwrap_or(1.0));
        by_chance.then(b.t.abs().total_cmp(&a.t.abs()))
    });
    tests.truncate(count);
    tests
}

/// What was found, what could have been found, and what cannot be said.
fn verdict(audit: &Audit, options: &AuditArgs) -> String {
    let tests = audit.overall.len() + audit.blocks.len();
    let (found, undecided) = (audit.findings().count(), audit.undecided().count());
    let (tolerance, confidence) = (percent(options.tolerance), percent(options.confidence));
    let mut text = if found > 0 {
        format!(
            "biased: {found} of {tests} means are off by more than {tolerance} and noise, at {confidence} confidence\n"
        )
    } else {
        format!("no bias of more than {tolerance} found in {tests} means, at {confidence} confidence\n")
    };
    if let Some(reach) = reach(audit, options) {
        let _ = writeln!(text, "half of the blocks would have shown a bias of {}", percent(reach));
    }
    if undecided > 0 {
        let in_layers: Vec<String> = std::iter::once(None)
            .chain((0..Layer::COUNT).map(Some))
            .filter_map(|layer| {
                let count = audit.undecided().filter(|test| test.layer == layer).count();
                (count > 0).then(|| format!("{} {count}", layer_name(layer)))
            })
            .collect();
        let _ = writeln!(
            text,
            "{undecided} means say nothing ({}): they hang on a few bright samples, or on light that no ray may have met yet; \
             a larger --budget decides more",
            in_layers.join(", ")
        );
    }
    text
}

/// The relative bias of a block's beauty that would have been found in half of the blocks; none where none is decided.
fn reach(audit: &Audit, options: &AuditArgs) -> Option<f64> {
    let decided: Vec<&AuditTest> = audit.blocks.iter().filter(|test| test.chance.is_some()).collect();
    let beauty = decided
        .iter()
        .filter(|test| test.layer.is_none() && test.tolerated > 0.0);
    let freedom = median(decided.iter().map(|test| test.freedom).collect())?;
    let level = (1.0 - options.confidence) / (2.0 * decided.len() as f64);
    let t = film::t_quantile(level, freedom);
    median(
        beauty
            .map(|test| options.tolerance * (1.0 + t * test.standard_error / test.tolerated))
            .collect(),
    )
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// An object with the same, at full precision. A number that is not finite, and a chance that is not known, is `null`.
pub(crate) fn json(judged: &Judged, options: &AuditArgs) -> String {
    let audit = &judged.audit;
    let test = |test: &AuditTest| {
        let block = test.block.map(|row| &judged.blocks[row]);
        serde_json::json!({
            "block": block.map(|b| [b.min.x, b.min.y, b.max.x, b.max.y]),
            "layer": layer_name(test.layer),
            "channel": CHANNELS[test.channel],
            "ours": test.ours,
            "traced": test.traced,
            "standard_error": test.standard_error,
            "freedom": test.freedom,
            "tolerated": test.tolerated,
            "t": test.t,
            "chance": test.chance,
        })
    };
    let value = serde_json::json!({
        "biased": audit.findings().count() > 0,
        "confidence": options.confidence,
        "tolerance": options.tolerance,
        "samples": audit.samples[0],
        "traced_samples": audit.samples[1],
        "findings": audit.findings().map(test).collect::<Vec<_>>(),
        "undecided": audit.undecided().count(),
        "overall": audit.overall.iter().map(test).collect::<Vec<_>>(),
        "blocks": audit.blocks.iter().map(test).collect::<Vec<_>>(),
    });
    format!("{value:#}\n")
}

fn layer_name(layer: Option<usize>) -> &'static str {
    layer.map_or("beauty", |layer| Layer::ALL[layer].name())
}

/// `caustic G`
fn name(test: &AuditTest) -> String {
    format!("{} {}", layer_name(test.layer), CHANNELS[test.channel])
}

/// First pixel of the block.
fn place(judged: &Judged, test: &AuditTest) -> String {
    test.block.map_or(String::new(), |row| {
        let min = judged.blocks[row].min;
        format!("{},{}", min.x, min.y)
    })
}

fn chance(test: &AuditTest) -> String {
    match test.chance {
        None => "undecided".into(),
        Some(p) if p < 1e-99 => "0".into(),
        Some(p) if p < 1e-3 => format!("{p:.0e}"),
        Some(p) => format!("{p:.3}"),
    }
}

fn signed_percent(share: f64) -> String {
    if share.is_finite() {
        format!("{:+.2} %", 100.0 * share)
    } else {
        "over black".into()
    }
}

/// `1 %`, with as many digits as it takes.
pub(crate) fn percent(share: f64) -> String {
    if share.is_finite() {
        format!("{} %", (share * 1e4).round() / 100.0)
    } else {
        "–".into()
    }
}
