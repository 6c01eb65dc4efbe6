//! `pipeline audit`: whether a scene's own methods are biased, by tracing random parts of the same image without bias.

use crate::args::AuditArgs;
use crate::audit_map;
use crate::audit_text;
use crate::exit::{Failure, titled};
use crate::interrupt;
use crate::outputs;
use crate::progress::{Display, Watcher};
use crate::session;
use crate::summary;
use crate::terminal::{print, say};
use film::{Audit, AuditOptions, Film, PixelBlock};
use pipeline_core::{Cancellation, Outcome, Progress, RenderClock, Report};
use pipeline_data::{ChosenBlocks, FilmSums, PixelChoice, RenderRequest, RenderSettings, TransportScene};
use transport::Layer;

/// An audit that was made, and what it was made of.
pub(crate) struct Judged {
    pub(crate) audit: Audit,
    pub(crate) ours: Film,
    pub(crate) traced: Film,
    pub(crate) blocks: Vec<PixelBlock>,
}

pub(crate) fn execute(options: &AuditArgs) -> Result<(), Failure> {
    outputs::check_distinct(&options.output)?;
    outputs::check_writable(&options.output)?;
    session::use_threads(options.threads)?;
    let display = Display::new(options.quiet);
    let cancellation = Cancellation::default();
    interrupt::listen(&cancellation, &display)?;
    let ours = render(own_request(options), RenderClock::default(), &cancellation, &display)?;
    ours.warnings
        .iter()
        .for_each(|warning| say(&titled("warning", warning)));
    if ours.outcome == Outcome::Interrupted {
        return Err(Failure::interrupted());
    }
    // Threads spend the processor's time side by side.
    let clock = RenderClock {
        time_limit: Some(options.budget / rayon::current_num_threads() as u32),
        ..RenderClock::default()
    };
    let traced = render(traced_request(options, ours.seed), clock, &cancellation, &display)?;
    for warning in &traced.warnings {
        // Of the settings of methods that trace nothing there is nothing to tell.
        if !ours.warnings.contains(warning) && !warning.contains("[unused-settings]") {
            say(&titled("warning", &format!("while tracing: {warning}")));
        }
    }
    let was_interrupted = traced.outcome == Outcome::Interrupted;
    let judged = judge(options, ours, traced)?;
    for path in &options.output {
        audit_map::write(path, &judged, 1.0 - options.confidence)
            .map_err(|error| Failure::failed(error.to_string()))?;
        if !options.quiet {
            say(&format!("wrote {}", path.display()));
        }
    }
    print(&if options.json {
        audit_text::json(&judged, options)
    } else {
        audit_text::table(&judged, options)
    })?;
    let found = judged.audit.findings().count();
    if was_interrupted {
        Err(Failure::interrupted())
    } else if found > 0 {
        Err(Failure::failed(format!(
            "the image is biased by more than {} in {found} means; see above",
            audit_text::percent(options.tolerance)
        )))
    } else {
        Ok(())
    }
}

/// One of the two renders.
struct Part {
    outcome: Outcome,
    film: Film,
    blocks: Vec<PixelBlock>,
    seed: u64,
    warnings: Vec<String>,
    /// Whether any surface has an S lobe.
    has_specular: bool,
    /// The largest radiance that a ray may meet.
    brightest: f64,
}

fn own_request(options: &AuditArgs) -> RenderRequest {
    RenderRequest {
        samples: options.samples,
        seed: options.seed,
        resolution: options.resolution.map(Into::into),
        crop: options.crop,
        pixels: Some(PixelChoice {
            side: options.block_size,
            count: options.blocks,
            seed: options.trial,
        }),
        ..session::scene_request(&options.scene)
    }
}

/// The same pixels, traced, with random numbers that have nothing to do with the others.
fn traced_request(options: &AuditArgs, seed: u64) -> RenderRequest {
    const APART: u64 = 0x5851_F42D_4C95_7F2D;
    RenderRequest {
        samples: Some(options.traced_samples.unwrap_or(1 << 24)),
        seed: Some(seed.wrapping_add(APART.wrapping_mul(options.trial.wrapping_add(1)))),
        traced: true,
        ..own_request(options)
    }
}

fn render(
    request: RenderRequest,
    clock: RenderClock,
    cancellation: &Cancellation,
    display: &Display,
) -> Result<Part, Failure> {
    let mut app = session::new_app();
    let limit = clock.time_limit;
    app.insert_resource(request)
        .insert_resource(clock)
        .insert_resource(cancellation.clone());
    let progress = app.world().resource::<Progress>().clone();
    let watcher = Watcher::start(progress, display.clone(), limit);
    let outcome = pipeline_core::render(&mut app);
    drop(watcher);
    if outcome == Outcome::BadScene {
        return Err(session::bad_scene(&app));
    }
    summary::tell_trouble(&app);
    let warnings = app.world().resource::<Report>().warnings().to_vec();
    let world = app.world_mut();
    let (Some(film), Some(blocks), Some(settings), Some(scene)) = (
        world.remove_resource::<FilmSums>(),
        world.remove_resource::<ChosenBlocks>(),
        world.get_resource::<RenderSettings>(),
        world.get_resource::<TransportScene>(),
    ) else {
        return Err(Failure::failed("nothing was rendered"));
    };
    Ok(Part {
        outcome,
        film: film.0,
        blocks: blocks.0,
        seed: settings.seed,
        warnings,
        has_specular: !scene.0.specular_targets().is_empty(),
        brightest: scene.0.lights.brightest().into(),
    })
}

fn judge(options: &AuditArgs, ours: Part, traced: Part) -> Result<Judged, Failure> {
    // Hits alone find light that comes over S lobes; it is looked for at D lobes only.
    let by_chance =
        |layer: &Layer| traced.has_specular && matches!(layer, Layer::Caustic | Layer::Specular | Layer::Indirect);
    let how = AuditOptions {
        significance: 1.0 - options.confidence,
        tolerance: options.tolerance,
        by_chance: Layer::ALL[..FilmSums::LAYERS].iter().map(by_chance).collect(),
        brightest: traced.brightest,
    };
    match film::audit(&ours.film, &traced.film, &ours.blocks, &how) {
        Some(audit) => Ok(Judged {
            audit,
            ours: ours.film,
            traced: traced.film,
            blocks: ours.blocks,
        }),
        None if traced.outcome == Outcome::Interrupted => Err(Failure::interrupted()),
        None => Err(Failure::failed(format!(
            "the budget was spent before every pixel had {} traced samples; give more with --budget, or look at fewer \
             pixels with --blocks",
            film::LEAST_AUDIT_SAMPLES
        ))),
    }
}
