use super::{Findings, component_place};
use crate::PrimIndex;
use bevy_ecs::component::Component;
use bevy_ecs::system::Query;
use scene_format::{Diagnostic, Scene};

/// The settings of a stage: a component on the prim that carries `Render`, `None` where it is missing or has no effect.
///
/// Warns of each that is written without effect.
///
/// - `name`: of the component, as in scene files.
/// - `render_prim`: row of the prim that carries `Render`.
/// - `unused`: why the component has no effect, as the end of a sentence; `None` where it has.
pub fn stage_settings<C: Component + Clone>(
    (name, written): (&str, &Query<(&PrimIndex, &C)>),
    render_prim: u32,
    unused: Option<&str>,
    scene: &Scene,
    findings: &mut Findings,
) -> Option<C> {
    let mut settings = None;
    for (prim, written) in written {
        let message = match unused {
            _ if prim.0 != render_prim => {
                format!("`{name}` stands on a prim that carries no `Render`; it has no effect there")
            }
            Some(reason) => format!("`{name}` has no effect: {reason}"),
            None => {
                settings = Some(written.clone());
                continue;
            }
        };
        let place = component_place(scene, prim.0, name);
        findings.push_at(place, Diagnostic::warning("unused-settings", message));
    }
    settings
}
