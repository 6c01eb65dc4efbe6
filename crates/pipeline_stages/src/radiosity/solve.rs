use super::plan::RadiosityPlan;
use bevy_ecs::prelude::*;
use pipeline_core::{Cancellation, Counters, Progress, RenderClock, record_items};
use pipeline_data::vocabulary::{Findings, SceneReport, component_place, field_place};
use pipeline_data::{RenderSettings, SolvedPatches, TransportScene};
use scene_format::Diagnostic;
use transport::{ExchangeError, ExchangeSettings, PatchField, PlaceError, PlaceSettings, Scene};

/// Points of patches where the scene says nothing; each stands for two sides.
const USUAL_POINTS: u32 = 4000;
/// Points of patches at most: a gigabyte with all that is kept of them.
const MOST_POINTS: u32 = 1 << 21;
/// Form factors at most: a gigabyte.
const MOST_LINKS: usize = 1 << 26;

/// Lays patches over the scene, finds their form factors and lets light go around.
#[expect(clippy::too_many_arguments, reason = "the plan, the scene, and whom to tell")]
pub(super) fn solve_radiosity(
    mut commands: Commands,
    plan: Option<Res<RadiosityPlan>>,
    scene: Option<Res<TransportScene>>,
    settings: Option<Res<RenderSettings>>,
    clock: Res<RenderClock>,
    cancellation: Res<Cancellation>,
    progress: Res<Progress>,
    mut counters: ResMut<Counters>,
    report: Option<SceneReport<'_>>,
) {
    let (Some(plan), Some(scene), Some(settings), Some(mut report)) = (plan, scene, settings, report) else {
        return;
    };
    if report.failed() {
        return;
    }
    let mut field = match place(&scene.0, &plan) {
        Ok(field) => field,
        Err(refusal) => return refuse(&mut report, settings.render_prim, *refusal),
    };
    tell_of_motion(&scene.0, &mut report, settings.render_prim);
    if clock.check_only || clock.photons_only {
        return;
    }
    let patches = field.patches().len();
    let exchange = ExchangeSettings {
        rays: plan.settings.rays,
        seed: plan.seed,
        most_links: MOST_LINKS,
    };
    progress.start("radiosity", "patches", 2 * patches as u64);
    let told = |before: usize| {
        let (progress, cancellation) = (&progress, &cancellation);
        move |done: usize| {
            progress.set_done((before + done) as u64);
            !cancellation.is_requested()
        }
    };
    let factors = transport::find_direct(&scene.0, &mut field, &exchange, told(0))
        .and_then(|()| transport::find_form_factors(&scene.0, &mut field, &exchange, told(patches)));
    let factors = match factors {
        Ok(factors) => factors,
        Err(ExchangeError::Stopped) => return,
        Err(ExchangeError::TooMany) => {
            let refusal = Diagnostic::error(
                "too-large",
                format!("radiosity found more than {MOST_LINKS} form factors, a gigabyte"),
            )
            .note("let `Radiosity.patch_size` be larger, or take fewer `rays`");
            return refuse(&mut report, settings.render_prim, refusal);
        }
    };
    let solution = factors.solve(&mut field, f64::from(plan.settings.tolerance), plan.reflections);
    record_items(patches);
    counters.counter("radiosity/patches").add(patches as u64);
    counters.counter("radiosity/form factors").add(factors.len() as u64);
    counters.counter("radiosity/rounds").add(solution.rounds.into());
    commands.insert_resource(SolvedPatches(field));
}

/// Lays the patches.
///
/// # Errors
/// What is wrong, for the scene's report.
fn place(scene: &Scene, plan: &RadiosityPlan) -> Result<PatchField, Box<Diagnostic>> {
    let settings = PlaceSettings {
        size: plan.settings.patch_size,
        usual: USUAL_POINTS,
        most: MOST_POINTS,
    };
    let refusal = |error| match error {
        PlaceError::TooMany { points, possible_size } => {
            let message = format!("radiosity would take {points:.0} patches; at most {MOST_POINTS} are used");
            let remedy = possible_size.map_or_else(
                || "there are too many surfaces; join them, or let `LightTransport.indirect` be another".to_owned(),
                |size| format!("let `Radiosity.patch_size` be {size:.2e} or more"),
            );
            Diagnostic::error("too-large", message).note(remedy)
        }
        PlaceError::Broken => Diagnostic::error("too-large", "no patches can be laid over this scene")
            .note("are all places and sizes finite?"),
    };
    PatchField::place(scene, &settings).map_err(|error| Box::new(refusal(error)))
}

/// Tells of surfaces that the solution leaves out.
fn tell_of_motion(scene: &Scene, report: &mut SceneReport<'_>, render_prim: u32) {
    let moves = |i: &u32| scene.rays.instance_moves(*i) && scene.material_of(*i).has_diffuse();
    let moving = (0..scene.rays.instance_count() as u32).filter(moves).count();
    if moving == 0 {
        return;
    }
    let message = format!("{moving} diffuse surfaces move; radiosity lays no patches over them, so they light nothing");
    let warning = Diagnostic::warning("moving-surfaces", message)
        .note("`LightTransport.indirect: PathTrace` or `IrradianceCache` know the light that they reflect");
    let mut findings = Findings::default();
    let place = component_place(report.scene(), render_prim, "Radiosity");
    findings.push_at(place, warning);
    report.file(findings);
}

/// Reports an error at the size of patches.
fn refuse(report: &mut SceneReport<'_>, render_prim: u32, refusal: Diagnostic) {
    let mut findings = Findings::default();
    let place = field_place(report.scene(), render_prim, "Radiosity", &["patch_size"]);
    findings.push_at(place, refusal);
    report.file(findings);
}
