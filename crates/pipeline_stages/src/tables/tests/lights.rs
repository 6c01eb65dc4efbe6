use super::{BALL, CAMERA, RENDER, SKY, errors, prepare, prepare_files, refusal, seen_at, warnings, with_rest};
use glam::Vec3;
use pipeline_data::TransportScene;
use radiometry::{Rgb, math};
use std::f32::consts::PI;

#[test]
fn power_is_spread_over_the_area() {
    let radiance = |prim: &str| seen_at(&with_rest(&format!("\"/A\": Def({prim}),\n")), 0.0, 0.0).1;
    // A quad of 2 m × 3 m: L = Φ / (π A).
    let one = radiance("Quad: (size: (2, 3)), Emission: (power: (6, 12, 0))");
    assert!(
        (one.r - 1.0 / PI).abs() < 1e-6 && (one.g - 2.0 / PI).abs() < 1e-6 && one.b == 0.0,
        "{one:?}"
    );
    let two = radiance("Quad: (size: (2, 3)), Emission: (power: (6, 6, 6), two_sided: true)");
    assert!((two.r - 0.5 / PI).abs() < 1e-6, "{two:?}");
    let scaled = radiance("Sphere: (), Transform: (scale: (2, 2, 2)), Emission: (power: (16, 16, 16))");
    assert!((scaled.r - 1.0 / (PI * PI)).abs() < 1e-5, "{scaled:?}");
    assert_eq!(
        radiance("Sphere: (), Emission: (radiance: (1, 2, 3))"),
        Rgb::new(1.0, 2.0, 3.0)
    );
}

#[test]
fn each_prim_that_shares_a_mesh_has_its_power() {
    let app = with_rest(
        "\"/A\": Def(Mesh: (file: \"quad.obj\"), Emission: (power: (1, 1, 1))),\n\
         \"/B\": Def(Mesh: (file: \"quad.obj\"), Emission: (power: (1, 1, 1)), Transform: (translate: (5, 0, 0), scale: (2, 1, 1))),\n",
    );
    assert!((seen_at(&app, 0.5, 0.3).1.r - 1.0 / PI).abs() < 1e-6);
    assert!((seen_at(&app, 6.0, 0.3).1.r - 0.5 / PI).abs() < 1e-6);
}

#[test]
fn a_material_that_emits_makes_its_geometry_shine() {
    let app = with_rest(
        "\"/Glow\": Def(Principled: (emission: (1, 2, 3))),\n\
         \"/A\": Def(Sphere: (), MaterialBinding: (target: \"/Glow\")),\n\
         \"/B\": Def(Sphere: (), MaterialBinding: (target: \"/Glow\"), Emission: (radiance: (5, 5, 5)), Transform: (translate: (5, 0, 0))),\n\
         \"/C\": Def(Sphere: (), Principled: (), Transform: (translate: (10, 0, 0))),\n",
    );
    assert_eq!(seen_at(&app, 0.0, 0.0).1, Rgb::new(1.0, 2.0, 3.0));
    assert_eq!(seen_at(&app, 5.0, 0.0).1, Rgb::splat(5.0));
    assert_eq!(seen_at(&app, 10.0, 0.0).1, Rgb::BLACK);
    assert!(seen_at(&app, 0.0, 0.0).0.bsdf.has_diffuse());
    // It is light enough for a scene without another.
    let lamp = "\"/A\": Def(Sphere: (), Principled: (emission: (1, 1, 1))),\n";
    assert_eq!(errors(&prepare(&[lamp, CAMERA, RENDER])), "");
}

#[test]
fn point_lights_shine_all_around() {
    let power = |light: &str| {
        let lamp = format!("\"/Lamp\": Def(PointLight: ({light}), Transform: (translate: (0, 3, 0))),\n");
        let app = prepare(&[BALL, &lamp, CAMERA, RENDER]);
        assert_eq!(errors(&app), "");
        app.world().resource::<TransportScene>().0.lights.power()
    };
    assert!((power("power: (10, 10, 10)") - 10.0).abs() < 1e-5);
    assert!((power("intensity: (1, 1, 1)") - 4.0 * std::f64::consts::PI).abs() < 1e-5);
    assert!((power("") - 1.0).abs() < 1e-6);
}

#[test]
fn spots_and_suns_have_the_power_and_direction_that_they_say() {
    let lights = |prim: &str| {
        let app = prepare(&[BALL, &format!("\"/Light\": Def({prim}),\n"), CAMERA, RENDER]);
        assert_eq!(errors(&app), "");
        app
    };
    let power = |prim: &str| lights(prim).world().resource::<TransportScene>().0.lights.power();
    assert!((power("SpotLight: (power: (5, 5, 5), inner_angle: 3, outer_angle: 40)") - 5.0).abs() < 1e-5);
    let cosine = |degrees: f32| f64::from(math::cos(degrees.to_radians()));
    let (inner, outer) = (cosine(20.0), cosine(30.0));
    let all = std::f64::consts::PI * (2.0 - inner - outer);
    assert!((power("SpotLight: (intensity: (1, 1, 1))") - all).abs() < 1e-5);
    let narrow = refusal("\"/S\": Def(SpotLight: (inner_angle: 40)),\n");
    assert!(
        narrow.contains("error[out-of-range]: `SpotLight.inner_angle` of 40"),
        "{narrow}"
    );
    // A sun in the south looks down: it is seen the other way.
    let app = lights("DistantLight: (angle: 2), Transform: (rotate: (-60, 0, 0))");
    let lights = &app.world().resource::<TransportScene>().0.lights;
    let sun = Vec3::new(0.0, math::sin(60_f32.to_radians()), math::cos(60_f32.to_radians()));
    assert_eq!(lights.escaped(sun, 0.0).count(), 1);
    assert_eq!(lights.escaped(-sun, 0.0).count(), 0);
}

#[test]
fn the_environment_is_scaled() {
    let sky = "\"/Sky\": Def(EnvironmentLight: (radiance: (1, 2, 3), scale: 0.5)),\n";
    let app = prepare(&[BALL, sky, CAMERA, RENDER]);
    assert_eq!(errors(&app), "");
    let lights = &app.world().resource::<TransportScene>().0.lights;
    let (radiance, _) = lights.escaped(Vec3::X, 0.0).next().unwrap();
    assert_eq!(radiance, Rgb::new(0.5, 1.0, 1.5));
}

#[test]
fn lights_that_cannot_be_are_refused() {
    let second = refusal("\"/More\": Def(EnvironmentLight: ()),\n");
    assert!(
        second.contains("error[two-environments]: both `/More` and `/Sky`"),
        "{second}"
    );
    assert!(
        second.contains("scene.ron:2:") && second.contains("scene.ron:3:"),
        "{second}"
    );
    let file = refusal("\"/More\": Def(EnvironmentLight: (file: \"quad.obj\")),\n");
    assert!(
        file.contains("error[bad-picture]")
            && file.contains("quad.obj: it is no PNG, JPEG, Radiance HDR or OpenEXR file"),
        "{file}"
    );
    let bright = refusal("\"/A\": Def(Sphere: (radius: 1e-18), Emission: (power: (1e30, 1, 1))),\n");
    assert!(
        bright.contains("error[too-bright]") && bright.contains("scene.ron:2:"),
        "{bright}"
    );
    let far = refusal("\"/A\": Def(Sphere: ()), \"/B\": Def(PointLight: (), Transform: (translate: (1e60, 0, 0))),\n");
    assert!(far.contains("error[too-far]: `/B`"), "{far}");
}

#[test]
fn a_scene_needs_light() {
    let none = errors(&prepare(&[BALL, CAMERA, RENDER]));
    assert!(
        none.contains("error[no-light]") && none.contains("PointLight: (power: (100, 100, 100))"),
        "{none}"
    );
    let dark = errors(&prepare(&[
        BALL,
        "\"/L\": Def(PointLight: (power: (0, 0, 0))),\n",
        CAMERA,
        RENDER,
    ]));
    assert!(
        dark.contains("error[no-light]") && dark.contains("scene.ron:3:"),
        "{dark}"
    );
}

#[test]
fn emission_without_a_surface_is_a_warning() {
    let app = with_rest(&format!("{BALL}\"/A\": Def(Emission: ()),\n"));
    assert_eq!(errors(&app), "");
    let text = warnings(&app);
    assert!(
        text.contains("warning[without-effect]: `Emission` of `/A`") && text.contains("scene.ron:3:"),
        "{text}"
    );
    let tiny = "Mesh: (file: \"quad.obj\"), Transform: (scale: (1e-60, 1e-60, 1e-60))";
    let app = with_rest(&format!("{BALL}\"/A\": Def(Emission: (), {tiny}),\n"));
    assert_eq!(errors(&app), "");
    assert!(warnings(&app).contains("warning[no-area]: `/A`"), "{}", warnings(&app));
}

#[test]
fn a_scene_without_geometry_shows_its_environment() {
    let app = prepare(&[SKY, CAMERA, RENDER]);
    assert_eq!(errors(&app), "");
    assert!(warnings(&app).contains("warning[no-geometry]"), "{}", warnings(&app));
    let empty = errors(&prepare(&["\"/L\": Def(PointLight: ()),\n", CAMERA, RENDER]));
    assert!(
        empty.contains("error[no-geometry]") && empty.contains("Sphere, Quad"),
        "{empty}"
    );
}

#[test]
fn caustics_that_tracing_cannot_find_are_a_warning() {
    let lamp = "\"/Lamp\": Def(PointLight: (), Transform: (translate: (0, 3, 0))),\n";
    let warned = |caustic: &str, material: &str| {
        let ball = format!("\"/Ball\": Def(Sphere: (), {material}),\n");
        let render = format!(
            "\"/Render\": Def(Render: (camera: \"/Camera\"), Film: (resolution: (4, 4)), LightTransport: (caustic: {caustic})),\n"
        );
        let app = prepare(&[&ball, lamp, CAMERA, &render]);
        assert_eq!(errors(&app), "");
        warnings(&app).contains("warning[unreachable-caustics]")
    };
    assert!(warned("Trace", "Dielectric: ()"));
    assert!(warned("Trace", "Plastic: (roughness: 0)"));
    assert!(warned("Trace", "Principled: (roughness: 0)"));
    assert!(warned("Trace", "Principled: (clearcoat: 0.5)"));
    assert!(!warned("Trace", "Plastic: (roughness: 0.5)"));
    assert!(!warned("PhotonMap", "Dielectric: ()"));
    assert!(!warned("Trace", "Diffuse: ()"));
    assert!(
        !warned("Trace", "Conductor: (roughness: 0.2)"),
        "light sampling finds it"
    );
}

#[test]
fn an_environment_that_turns_while_the_shutter_is_open_is_a_warning() {
    let warned = |file: &str| {
        let turns = "Transform: (rotate: Samples({0: (0, 0, 0), 1: (0, 90, 0)}))";
        let sky = format!("\"/Sky\": Def(EnvironmentLight: ({file}), {turns}),\n");
        let camera = "\"/Camera\": Def(Camera: (), MotionBlur: (shutter: (0, 1))),\n";
        let picture = |folder: &std::path::Path| {
            let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n".as_slice();
            let texels = [128, 128, 128, 129, 64, 64, 64, 129];
            std::fs::write(folder.join("sky.hdr"), [header, &texels].concat()).unwrap();
        };
        let app = prepare_files(&[&sky, BALL, camera, RENDER], picture, |_| ());
        assert_eq!(errors(&app), "");
        warnings(&app)
    };
    let text = warned("file: \"sky.hdr\"");
    assert!(text.contains("the environment of `/Sky` is not blurred"), "{text}");
    assert_eq!(warned(""), "", "it looks the same however it is turned");
}
