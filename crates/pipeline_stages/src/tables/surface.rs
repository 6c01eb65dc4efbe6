//! From a material component to the row that light transport reads.

use pipeline_data::vocabulary::{Conductor, Dielectric, Findings, Plastic, Principled, field_place};
use radiometry::{Rgb, math};
use scattering::{
    Bsdf, ConductorBsdf, ConductorFresnel, DielectricBsdf, Dispersion, Metal, Microsurface, NormalDistribution,
    PlasticBsdf,
};
use scene_format::{Diagnostic, FieldState, Scene};
use transport::Material;

/// A metal. An unknown one is reported, and black; what has no effect is reported as well.
pub(super) fn conductor_material(
    conductor: &Conductor,
    specular_alpha: f32,
    scene: &Scene,
    prim: u32,
    findings: &mut Findings,
) -> Material {
    let fresnel = match (&conductor.metal, conductor.eta, conductor.k, conductor.f0) {
        (Some(name), ..) => Metal::from_name(name).map(ConductorFresnel::from).unwrap_or_else(|| {
            findings.push_at(field_place(scene, prim, "Conductor", &["metal"]), unknown_metal(name));
            ConductorFresnel::Constant(Rgb::BLACK)
        }),
        (_, Some(eta), Some(k), _) => ConductorFresnel::Complex {
            eta: eta.into(),
            k: k.into(),
        },
        (_, _, _, Some(f0)) => ConductorFresnel::Schlick(f0.into()),
        _ => ConductorFresnel::Constant(conductor.reflectance.into()),
    };
    let surface = Microsurface::from_roughness(conductor.roughness, specular_alpha)
        .with_energy_compensation(conductor.energy_compensation);
    let distribution = conductor.distribution.into();
    if distribution == NormalDistribution::Beckmann && conductor.energy_compensation {
        warn_of_compensation(scene, prim, findings);
    }
    let bsdf = ConductorBsdf::new(fresnel, surface)
        .with_distribution(distribution)
        .with_tint(conductor.tint.into());
    Material {
        bsdf: Bsdf::Conductor(bsdf),
        ..Material::default()
    }
}

/// Energy compensation is on by default, so only who writes it is told that a Beckmann surface has none.
fn warn_of_compensation(scene: &Scene, prim: u32, findings: &mut Findings) {
    let conductor = scene.prims[prim as usize].component("Conductor");
    let written = conductor.and_then(|found| found.field("energy_compensation"));
    if let Some(field) = written.filter(|field| !matches!(field.state, FieldState::Blocked)) {
        let finding = Diagnostic::warning(
            "without-effect",
            "`energy_compensation` of a Beckmann surface has no effect",
        )
        .note("what such a surface loses is not tabulated; `Ggx` has it");
        findings.push_at(Some(field.place), finding);
    }
}

fn unknown_metal(name: &str) -> Diagnostic {
    let folded = name.to_ascii_lowercase();
    let distance = |known: &str| strsim::damerau_levenshtein(&folded, known);
    let nearest = Metal::names()
        .min_by_key(|known| distance(known))
        .filter(|known| distance(known) <= 2);
    let names: Vec<&str> = Metal::names().collect();
    Diagnostic::error("unknown-metal", format!("there is no metal `{name}`"))
        .suggest(nearest)
        .note(format!("metals: {}", names.join(", ")))
        .note("for another one, write `eta` and `k`, or `f0`")
}

/// Glass, or a pane. What cannot be served is reported.
pub(super) fn dielectric_material(
    dielectric: &Dielectric,
    specular_alpha: f32,
    scene: &Scene,
    prim: u32,
    findings: &mut Findings,
) -> Material {
    let place = |field: &str| field_place(scene, prim, "Dielectric", &[field]);
    if !dielectric.thin {
        let surface = Microsurface::from_roughness(dielectric.roughness, specular_alpha)
            .with_energy_compensation(dielectric.energy_compensation);
        return Material {
            bsdf: Bsdf::Dielectric(DielectricBsdf::new(dielectric.ior, dielectric.tint.into(), surface)),
            absorption: dielectric.absorption.into(),
            priority: dielectric.priority,
            dispersion: dielectric
                .dispersion
                .map(|abbe| Dispersion::from_abbe(dielectric.ior, abbe)),
            ..Material::default()
        };
    }
    if dielectric.roughness > 0.0 {
        let finding = Diagnostic::error("rough-pane", "a `Dielectric` that is `thin` cannot have `roughness`")
            .note("give the pane a thickness: a closed `Cuboid` without `thin`");
        findings.push_at(place("roughness"), finding);
    }
    if dielectric.absorption != glam::Vec3::ZERO {
        let finding = Diagnostic::warning("without-effect", "`absorption` of a `thin` dielectric has no effect")
            .note("a pane has no inside; `tint` colours it");
        findings.push_at(place("absorption"), finding);
    }
    if dielectric.dispersion.is_some() {
        let finding = Diagnostic::warning("without-effect", "`dispersion` of a `thin` dielectric has no effect")
            .note("a pane does not bend light");
        findings.push_at(place("dispersion"), finding);
    }
    Material {
        bsdf: Bsdf::Dielectric(DielectricBsdf::thin(dielectric.ior, dielectric.tint.into())),
        ..Material::default()
    }
}

/// A matt base under a coat.
pub(super) fn plastic_material(plastic: &Plastic, specular_alpha: f32) -> Material {
    let surface = Microsurface::from_roughness(plastic.roughness, specular_alpha);
    Material {
        bsdf: Bsdf::Plastic(PlasticBsdf::new(plastic.albedo.into(), plastic.ior, surface)),
        ..Material::default()
    }
}

/// What a `Principled` has beside its inputs.
pub(super) fn principled_interior(principled: &Principled, material: Material) -> Material {
    let absorption = match principled.attenuation_distance {
        Some(distance) if material.has_inside() => absorption_of(principled.attenuation_color.into(), distance),
        _ => Rgb::BLACK,
    };
    Material {
        absorption,
        priority: principled.priority,
        ..material
    }
}

/// The coefficient that leaves `colour` after `distance`: σ = −ln(colour)/distance, in m⁻¹.
fn absorption_of(colour: Rgb, distance: f32) -> Rgb {
    /// Nothing left would take an infinite coefficient.
    const LEAST: f32 = 1e-6;
    colour.map(|c| -math::ln(c.clamp(LEAST, 1.0)) / distance)
}
