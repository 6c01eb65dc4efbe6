use crate::{ComposedScene, RenderRequest};
use bevy_ecs::change_detection::{Res, ResMut};
use bevy_ecs::system::SystemParam;
use pipeline_core::Report;
use scene_format::{Diagnostic, Diagnostics, Place, Scene, Severity, Sources};

/// At most this many errors of one system are reported; more would hide the first.
const MOST_ERRORS: usize = 20;

/// What a system found wrong with a scene, on its way to the [`Report`].
///
/// A system goes on after an error, so that one run shows all of them.
#[derive(Clone, Debug, Default)]
pub struct Findings(Vec<Diagnostic>);

impl Findings {
    /// Adds an error or a warning.
    pub fn push(&mut self, finding: Diagnostic) {
        self.0.push(finding);
    }

    /// Adds an error or a warning at a place, if there is one.
    pub fn push_at(&mut self, place: Option<Place>, finding: Diagnostic) {
        self.push(match place {
            Some(place) => finding.at(place),
            None => finding,
        });
    }

    /// True when there is an error.
    #[must_use]
    pub fn has_error(&self) -> bool {
        self.0.iter().any(|found| found.severity == Severity::Error)
    }

    /// Writes everything to the report as text with excerpts of `scene`, up to 20 errors.
    pub fn file(self, scene: &Scene, request: &RenderRequest, report: &mut Report) {
        file(&self.0, 0, &scene.sources, request.colour, report);
    }

    /// Writes what loading found wrong to the report.
    pub fn file_refusal(refusal: &Diagnostics, request: &RenderRequest, report: &mut Report) {
        file(&refusal.list, refusal.omitted, &refusal.sources, request.colour, report);
    }
}

/// What a system that checks the scene needs: the scene, the request, and where to say what is wrong.
#[derive(SystemParam)]
pub struct SceneReport<'w> {
    composed: Res<'w, ComposedScene>,
    request: Res<'w, RenderRequest>,
    report: ResMut<'w, Report>,
}

impl SceneReport<'_> {
    /// The composed scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.composed.0
    }

    /// What was asked for.
    #[must_use]
    pub fn request(&self) -> &RenderRequest {
        &self.request
    }

    /// True when there was an error, of this system or an earlier one.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.report.failed()
    }

    /// Writes what was found to the report.
    pub fn file(&mut self, findings: Findings) {
        findings.file(&self.composed.0, &self.request, &mut self.report);
    }
}

fn file(list: &[Diagnostic], omitted: usize, sources: &Sources, colour: bool, report: &mut Report) {
    let mut errors = 0;
    for finding in list {
        let is_error = finding.severity == Severity::Error;
        errors += usize::from(is_error);
        if !is_error {
            report.warn(finding.render(sources, colour));
        } else if errors <= MOST_ERRORS {
            report.fail(finding.render(sources, colour));
        }
    }
    let omitted = omitted + errors.saturating_sub(MOST_ERRORS);
    if omitted > 0 {
        report.fail(format!("and {omitted} more errors\n"));
    }
}

/// Where a component of a prim is written, else the prim.
///
/// - `prim`: row of [`Scene::prims`], as [`PrimIndex`](crate::PrimIndex) holds it.
#[must_use]
pub fn component_place(scene: &Scene, prim: u32, component: &str) -> Option<Place> {
    let prim = scene.prims.get(prim as usize)?;
    prim.component(component).map(|found| found.place).or(prim.place)
}

/// Where the first of some fields that is written stands, else the component, else the prim.
#[must_use]
pub fn field_place(scene: &Scene, prim: u32, component: &str, fields: &[&str]) -> Option<Place> {
    let found = scene
        .prims
        .get(prim as usize)
        .and_then(|prim| prim.component(component));
    let field = found.and_then(|found| fields.iter().find_map(|name| found.field(name)));
    field
        .map(|field| field.place)
        .or_else(|| component_place(scene, prim, component))
}
