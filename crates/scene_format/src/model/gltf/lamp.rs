//! Lights and cameras.

use glam::DVec3;

use super::super::error::Fault;
use super::super::write::Component;
use super::Translation;
use super::graph::no_such;
use super::json::{Camera, Light, Spot};

/// The range of `Camera.fov` in degrees.
const FOV: std::ops::RangeInclusive<f64> = 0.01..=179.0;

impl Translation<'_> {
    /// Converts the light that a node carries.
    pub(super) fn light(&mut self, index: u32, at: &str) -> Result<Option<Component>, Fault> {
        let lights = &self.root.extensions.lights_punctual.lights;
        let Some(light) = lights.get(index as usize) else {
            let at = format!("{at}.extensions.KHR_lights_punctual.light");
            return Err(no_such(&at, "light", index, lights.len()));
        };
        let at = format!("extensions.KHR_lights_punctual.lights[{index}]");
        let strength = strength(light, &at)?;
        let (component, what) = match light.kind.as_str() {
            "point" => (
                Component::new("PointLight").vector("intensity", strength),
                "point lights",
            ),
            "spot" => {
                let spot = Component::new("SpotLight").vector("intensity", strength);
                let (inner, outer) = cone(light.spot.as_ref(), &at)?;
                let spot = spot.number("inner_angle", inner).number("outer_angle", outer);
                (spot, "spot lights")
            }
            "directional" => (
                Component::new("DistantLight").vector("irradiance", strength),
                "directional lights",
            ),
            kind => {
                let at = format!("{at}.type");
                return Err(Fault::invalid(&at, format!("{kind:?} is not a kind of light")));
            }
        };
        Ok(self.knows(component.name, what).then_some(component))
    }

    /// Converts the camera that a node carries.
    pub(super) fn camera(&mut self, index: u32, at: &str) -> Result<Option<Component>, Fault> {
        let cameras = &self.root.cameras;
        let Some(camera) = cameras.get(index as usize) else {
            return Err(no_such(&format!("{at}.camera"), "camera", index, cameras.len()));
        };
        let at = format!("cameras[{index}]");
        let Some(fov) = fov(camera, &at)? else {
            self.left_out.insert("orthographic cameras");
            return Ok(None);
        };
        if !self.knows("Camera", "cameras") {
            return Ok(None);
        }
        let shown = fov.clamp(*FOV.start(), *FOV.end());
        if shown != fov {
            let message = format!("an angle of {fov} degrees is out of range, {shown} is used");
            self.warn(&format!("{at}.perspective.yfov"), message);
        }
        Ok(Some(Component::new("Camera").number("fov", shown)))
    }
}

/// The vertical angle of view in degrees; none for a camera without one.
fn fov(camera: &Camera, at: &str) -> Result<Option<f64>, Fault> {
    match (camera.kind.as_str(), &camera.perspective) {
        ("perspective", Some(perspective)) if perspective.yfov > 0.0 => Ok(Some(perspective.yfov.to_degrees())),
        ("perspective", Some(perspective)) => {
            let message = format!("an angle of {} is not above 0", perspective.yfov);
            Err(Fault::invalid(&format!("{at}.perspective.yfov"), message))
        }
        ("perspective", None) => Err(Fault::invalid(&format!("{at}.perspective"), "it is missing")),
        ("orthographic", _) => Ok(None),
        (kind, _) => Err(Fault::invalid(
            &format!("{at}.type"),
            format!("{kind:?} is not a kind of camera"),
        )),
    }
}

fn strength(light: &Light, at: &str) -> Result<DVec3, Fault> {
    let colour = DVec3::from_array(light.color.unwrap_or([1.0; 3]));
    let strength = colour * light.intensity.unwrap_or(1.0);
    if strength.min_element() < 0.0 || strength.max_element() > f64::from(f32::MAX) || !strength.is_finite() {
        let message = format!("a light of {strength} cannot be computed with");
        return Err(Fault::invalid(&format!("{at}.intensity"), message).remedy("choose an intensity from 0 to 1e38"));
    }
    Ok(strength)
}

/// Half angles of a cone in degrees, inner and outer.
fn cone(spot: Option<&Spot>, at: &str) -> Result<(f64, f64), Fault> {
    let inner = spot.and_then(|spot| spot.inner_cone_angle).unwrap_or(0.0);
    let outer = spot
        .and_then(|spot| spot.outer_cone_angle)
        .unwrap_or(std::f64::consts::FRAC_PI_4);
    // A right angle that was rounded up is one.
    let right = std::f64::consts::FRAC_PI_2;
    if !(0.0 <= inner && inner < outer && outer <= right + 1e-6) {
        let message = format!("angles of {inner} and {outer} are not 0 ≤ inner < outer ≤ π/2");
        return Err(Fault::invalid(&format!("{at}.spot"), message));
    }
    Ok((inner.to_degrees(), outer.min(right).to_degrees()))
}
