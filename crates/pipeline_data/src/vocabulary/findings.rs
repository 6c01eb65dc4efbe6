use crate::RenderRequest;
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
    let found = scene.prims.get(prim as usize).and_then(|prim| prim.component(component));
    let field = found.and_then(|found| fields.iter().find_map(|name| found.field(name)));
    field.map(|field| field.place).or_else(|| component_place(scene, prim, component))
}
