use super::{CAMERA, SKY, prepare, refusal, seen_at, warnings, with_rest};
use bevy_app::App;
use glam::Vec3;
use radiometry::Rgb;
use scattering::{Bsdf, LobeClass};
use transport::Material;

fn albedo_at(app: &App, x: f32) -> Rgb {
    match seen_at(app, x, 0.0).0.bsdf {
        Bsdf::Diffuse(diffuse) => diffuse.albedo(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_nearest_material_wins() {
    let app = with_rest(
        r#""/Looks": Def(children: {"Red": Def(Diffuse: (albedo: (1, 0, 0))), "Green": Def(Diffuse: (albedo: (0, 1, 0)))}),
        "/World": Def(MaterialBinding: (target: "/Looks/Red"), children: {
            "Inherits": Def(children: {"Deep": Def(Sphere: ())}),
            "Binds": Def(Sphere: (), MaterialBinding: (target: "/Looks/Green"), Transform: (translate: (3, 0, 0))),
            "Owns": Def(Sphere: (), MaterialBinding: (target: "/Looks/Green"), Diffuse: (albedo: (0, 0, 1)),
                Transform: (translate: (6, 0, 0))),
        }),
        "/Plain": Def(Sphere: (), Transform: (translate: (9, 0, 0))),
        "/Lamp": Def(Sphere: (), Emission: (), Transform: (translate: (12, 0, 0))),
        "/Both": Def(Sphere: (), Emission: (), Diffuse: (), Transform: (translate: (15, 0, 0))),
        "#,
    );
    assert_eq!(albedo_at(&app, 0.0), Rgb::new(1.0, 0.0, 0.0));
    assert_eq!(albedo_at(&app, 3.0), Rgb::new(0.0, 1.0, 0.0));
    assert_eq!(albedo_at(&app, 6.0), Rgb::new(0.0, 0.0, 1.0));
    assert_eq!(albedo_at(&app, 9.0), Rgb::splat(0.5));
    assert_eq!(seen_at(&app, 12.0, 0.0).0.bsdf, Bsdf::Black);
    assert_eq!(albedo_at(&app, 15.0), Rgb::splat(0.5));
}

#[test]
fn materials_become_the_bsdfs_that_they_describe() {
    let look = |material: &str| seen_at(&with_rest(&format!("\"/A\": Def(Sphere: (), {material}),\n")), 0.0, 0.0).0;
    let head_on = |material: &Material| material.bsdf.albedo(Vec3::Z);
    let gold = look("Conductor: (metal: \"Gold\")");
    assert!(head_on(&gold).r > 0.9 && head_on(&gold).b < 0.5 && gold.bsdf.has_specular());
    assert_eq!(head_on(&look("Conductor: ()")), Rgb::WHITE);
    assert!((head_on(&look("Conductor: (f0: (0.25, 0.5, 0.75))")).g - 0.5).abs() < 1e-6);
    let glassy = look("Conductor: (eta: (1.5, 1.5, 1.5), k: (0, 0, 0))");
    assert!((head_on(&glassy).r - 0.04).abs() < 1e-5);
    // α = 0.2² = 0.04 is below the threshold of 0.05, 0.3² = 0.09 above.
    assert!(look("Conductor: (roughness: 0.2)").bsdf.has_specular());
    assert!(look("Conductor: (roughness: 0.3)").bsdf.has_diffuse());
    let rough = look("Conductor: (roughness: 1, energy_compensation: false)").bsdf;
    assert!(matches!(rough, Bsdf::Conductor(b) if !b.surface().has_energy_compensation()));
    let glass = look("Dielectric: (absorption: (1, 2, 3), tint: (0.5, 1, 1))");
    assert_eq!(glass.absorption, Rgb::new(1.0, 2.0, 3.0));
    assert!(matches!(glass.bsdf, Bsdf::Dielectric(b) if !b.is_thin() && b.surface().class() == LobeClass::Specular));
    let pane = with_rest("\"/A\": Def(Quad: (), Dielectric: (thin: true)),\n");
    assert!(matches!(seen_at(&pane, 0.0, 0.0).0.bsdf, Bsdf::Dielectric(b) if b.is_thin()));
}

#[test]
fn beckmann_has_no_energy_compensation_and_says_so_where_it_is_asked_for() {
    let with = |fields: &str| {
        with_rest(&format!(
            "\"/A\": Def(Sphere: (), Conductor: (roughness: 0.5{fields})),\n"
        ))
    };
    let compensated = |app: &App| match seen_at(app, 0.0, 0.0).0.bsdf {
        Bsdf::Conductor(metal) => metal.surface().has_energy_compensation(),
        other => panic!("{other:?}"),
    };
    assert!(compensated(&with("")) && compensated(&with(", distribution: Ggx")));
    for silent in ["", ", energy_compensation: false", ", energy_compensation: Block"] {
        let app = with(&format!(", distribution: Beckmann{silent}"));
        assert!(!compensated(&app) && warnings(&app).is_empty(), "{silent}");
    }
    let app = with(", distribution: Beckmann, energy_compensation: true");
    let text = warnings(&app);
    assert!(!compensated(&app));
    assert!(
        text.contains("warning[without-effect]: `energy_compensation`") && text.contains("scene.ron:2:"),
        "{text}"
    );
}

#[test]
fn a_metal_is_tinted() {
    let app = with_rest("\"/A\": Def(Sphere: (), Conductor: (reflectance: (1, 1, 0.5), tint: (0.5, 1, 0.5))),\n");
    let albedo = seen_at(&app, 0.0, 0.0).0.bsdf.albedo(Vec3::Z);
    assert_eq!(albedo, Rgb::new(0.5, 1.0, 0.25));
}

#[test]
fn layered_materials_become_their_bsdfs() {
    let look = |material: &str| seen_at(&with_rest(&format!("\"/A\": Def(Sphere: (), {material}),\n")), 0.0, 0.0).0;
    let plastic = look("Plastic: (albedo: (1, 0, 0))");
    assert!(plastic.bsdf.has_specular() && plastic.bsdf.has_diffuse() && !plastic.bsdf.transmits());
    // Head-on, 4 % of the coat and what the base returns.
    let albedo = plastic.bsdf.albedo(Vec3::Z);
    assert!(
        (albedo.r - 1.0).abs() < 5e-3 && (albedo.g - 0.04).abs() < 5e-3,
        "{albedo:?}"
    );
    assert!(look("Plastic: (roughness: 0.5)").bsdf.has_diffuse());

    let metal = look("Principled: (metallic: 1, roughness: 0.1, base_color: (0.9, 0.6, 0.3))");
    assert!(metal.bsdf.has_specular() && !metal.bsdf.has_diffuse() && !metal.bsdf.transmits());
    let wall = look("Principled: (transmission: 1, roughness: 0)");
    assert!(wall.bsdf.transmits() && !wall.bsdf.has_inside() && !wall.bsdf.needs_light_sampling());
    let solid = look(
        "Principled: (transmission: 1, thickness: 0.1, attenuation_color: (0.5, 1, 0.25), attenuation_distance: 0.5)",
    );
    assert!(solid.bsdf.has_inside());
    let ln2 = std::f32::consts::LN_2;
    assert!(
        (solid.absorption.r - 2.0 * ln2).abs() < 1e-5 && solid.absorption.g == 0.0,
        "{solid:?}"
    );
    assert!((solid.absorption.b - 4.0 * ln2).abs() < 1e-5, "{solid:?}");
    assert_eq!(
        look("Principled: (attenuation_color: (0, 0, 0), attenuation_distance: 1)").absorption,
        Rgb::BLACK
    );
    assert!(
        look("Principled: (sheen: (1, 1, 1), metallic: 1, roughness: 0)")
            .bsdf
            .has_diffuse()
    );
}

#[test]
fn the_threshold_of_light_transport_decides_what_is_specular() {
    let render = "\"/Render\": Def(Render: (camera: \"/Camera\"), LightTransport: (specular_alpha: 0.5)),\n";
    let app = prepare(&[
        "\"/A\": Def(Sphere: (), Conductor: (roughness: 0.5)),\n",
        SKY,
        CAMERA,
        render,
    ]);
    assert!(seen_at(&app, 0.0, 0.0).0.bsdf.has_specular());
}

#[test]
fn materials_that_cannot_be_are_refused_with_their_place() {
    for (bad, expected) in [
        (
            "\"/A\": Def(Sphere: (), Diffuse: (), Conductor: ()),\n",
            "error[two-materials]: `/A` has two materials",
        ),
        (
            "\"/A\": Def(Sphere: (), Conductor: (metal: \"gilver\")),\n",
            "did you mean `silver`?",
        ),
        (
            "\"/A\": Def(Sphere: (), Conductor: (metal: \"mithril\")),\n",
            "metals: aluminium, beryllium, chrome",
        ),
        ("\"/A\": Def(Quad: (), Dielectric: ()),\n", "error[open-geometry]: `/A`"),
        (
            "\"/A\": Def(Cylinder: (capped: false), Dielectric: ()),\n",
            "error[open-geometry]: `/A`",
        ),
        (
            "\"/A\": Def(Mesh: (file: \"quad.obj\"), Dielectric: ()),\n",
            "write `Dielectric: (thin: true)`",
        ),
        (
            "\"/A\": Def(Sphere: (), Plastic: (), Principled: ()),\n",
            "error[two-materials]: `/A`",
        ),
        (
            "\"/A\": Def(Quad: (), Principled: (transmission: 1, thickness: 0.1)),\n",
            "write `Principled: (thickness: 0)`",
        ),
        (
            "\"/A\": Def(Quad: (), Dielectric: (thin: true, roughness: 0.5)),\n",
            "error[rough-pane]",
        ),
        (
            "\"/A\": Def(Sphere: (), MaterialBinding: (target: \"/Camera\")),\n",
            "error[no-material]: `/Camera` has no",
        ),
        (
            "\"/A\": Def(MaterialBinding: (target: \"/B\")), \"/B\": Class(Diffuse: ()),\n",
            "`/B` is not rendered",
        ),
    ] {
        let text = refusal(bad);
        assert!(
            text.contains(expected) && text.contains("scene.ron:2:"),
            "{bad}: {text}"
        );
    }
}

#[test]
fn bound_glass_needs_a_closed_surface_too() {
    let text = refusal(
        "\"/Glass\": Def(Dielectric: ()),\n\"/A\": Def(MaterialBinding: (target: \"/Glass\"), children: {\"B\": Def(Disc: ())}),\n",
    );
    assert!(
        text.contains("`/A/B` is of glass") && text.contains("scene.ron:3:"),
        "{text}"
    );
    assert!(
        text.contains("the material: ") && text.contains("scene.ron:2:"),
        "{text}"
    );
}

#[test]
fn a_good_message() {
    let text = refusal("\"/Ring\": Def(Band: (), Conductor: (metal: \"glod\", roughness: 0.1)),\n");
    let (_, below) = text.split_once('\n').unwrap();
    assert!(
        text.starts_with("error[unknown-metal]: there is no metal `glod`\n"),
        "{text}"
    );
    let below: Vec<&str> = below.lines().skip(1).collect();
    assert_eq!(
        below,
        [
            "   |",
            " 2 | \"/Ring\": Def(Band: (), Conductor: (metal: \"glod\", roughness: 0.1)),",
            "   |                                           ^^^^^^ did you mean `gold`?",
            "   = metals: aluminium, beryllium, chrome, copper, gold, iridium, mercury, silver, tungsten, vanadium",
            "   = for another one, write `eta` and `k`, or `f0`",
        ],
    );
}

#[test]
fn holes_in_glass_are_a_warning() {
    let glass = |rest: &str| {
        let prims = format!("\"/A\": Def(Sphere: (), Principled: (transmission: 1, thickness: 1{rest})),\n");
        warnings(&with_rest(&prims))
    };
    assert!(glass(", alpha: 0.5").contains("warning[alpha-in-glass]: the glass of `/A`"));
    assert_eq!(glass(""), "");
}
