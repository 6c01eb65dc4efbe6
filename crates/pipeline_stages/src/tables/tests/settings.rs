use super::{BALL, CAMERA, RENDER, SKY, errors, prepare, prepare_with, warnings, with_rest};
use bevy_app::App;
use film::{FilterKind, ToneMap};
use glam::{UVec2, Vec2, Vec3};
use pipeline_data::{CameraFrame, RenderRequest, RenderSettings};
use transport::{CausticMethod, DirectMethod, IndirectMethod};

fn settings(app: &App) -> &RenderSettings {
    assert_eq!(errors(app), "");
    app.world().resource::<RenderSettings>()
}

#[test]
fn settings_come_from_the_render_prim() {
    let render = "\"/R\": Def(Render: (camera: \"/Camera\", samples: 7, max_depth: 9, seed: 3),
        Film: (resolution: (8, 6), filter: Box, filter_radius: 0.5, exposure: 1, tone_map: Srgb),
        LightTransport: (direct: Off, specular: Off, caustic: Trace, indirect: Off, specular_alpha: 0.1)),\n";
    let app = prepare(&[BALL, SKY, CAMERA, render]);
    let settings = settings(&app);
    assert_eq!(
        (settings.samples, settings.seed, settings.resolution),
        (7, 3, UVec2::new(8, 6))
    );
    assert_eq!((settings.crop_min, settings.crop_max), (UVec2::ZERO, UVec2::new(8, 6)));
    assert_eq!((settings.filter, settings.filter_radius), (FilterKind::Box, 0.5));
    assert_eq!((settings.exposure, settings.tone_map), (1.0, ToneMap::Srgb));
    let methods = settings.methods;
    assert_eq!(
        (methods.direct, methods.caustic),
        (DirectMethod::Off, CausticMethod::Trace)
    );
    assert_eq!((methods.specular, methods.indirect), (false, IndirectMethod::Off));
    assert_eq!((methods.specular_alpha, methods.max_depth), (0.1, 9));
    let plain = prepare(&[BALL, SKY, CAMERA, "\"/R\": Def(Render: (camera: \"/Camera\")),\n"]);
    let plain = self::settings(&plain);
    assert_eq!(
        (plain.samples, plain.resolution, plain.methods.max_depth),
        (64, UVec2::splat(512), u32::MAX)
    );
    assert_eq!(
        (plain.methods.caustic, plain.methods.indirect),
        (CausticMethod::PhotonMap, IndirectMethod::IrradianceCache)
    );
}

#[test]
fn the_command_line_wins_over_the_scene() {
    let app = prepare_with(&[BALL, SKY, CAMERA, RENDER], |request| {
        request.samples = Some(3);
        request.seed = Some(11);
        request.resolution = Some(UVec2::new(20, 10));
        request.crop = Some([2, 3, 20, 4]);
    });
    let settings = settings(&app);
    assert_eq!(
        (settings.samples, settings.seed, settings.resolution),
        (3, 11, UVec2::new(20, 10))
    );
    assert_eq!(
        (settings.crop_min, settings.crop_max),
        (UVec2::new(2, 3), UVec2::new(20, 4))
    );
}

#[test]
fn requests_that_cannot_be_are_refused() {
    let refusal = |adjust: fn(&mut RenderRequest)| errors(&prepare_with(&[BALL, SKY, CAMERA, RENDER], adjust));
    for crop in [[0, 0, 5, 4], [2, 0, 2, 4], [3, 0, 1, 4]] {
        let text = errors(&prepare_with(&[BALL, SKY, CAMERA, RENDER], |request| {
            request.crop = Some(crop)
        }));
        assert!(text.contains("error[bad-crop]") && text.contains("4 × 4"), "{text}");
    }
    assert!(refusal(|r| r.samples = Some(0)).contains("error[out-of-range]: the number of samples"));
    assert!(refusal(|r| r.resolution = Some(UVec2::new(0, 4))).contains("error[out-of-range]: the resolution"));
    assert!(refusal(|r| r.resolution = Some(UVec2::splat(65_537))).contains("error[out-of-range]: the resolution"));
    let large = refusal(|r| r.resolution = Some(UVec2::splat(60_000)));
    assert!(
        large.contains("error[too-large]") && large.contains("GiB") && !large.contains("-->"),
        "{large}"
    );
}

#[test]
fn a_film_that_does_not_fit_is_refused_with_its_place() {
    let render = "\"/Render\": Def(Render: (camera: \"/Camera\"), Film: (resolution: (65536, 65536))),\n";
    let text = errors(&prepare(&[BALL, SKY, CAMERA, render]));
    assert!(
        text.contains("error[too-large]") && text.contains("scene.ron:5:"),
        "{text}"
    );
    let crop = prepare_with(&[BALL, SKY, CAMERA, render], |request| {
        request.crop = Some([0, 0, 8, 8])
    });
    assert_eq!(errors(&crop), "", "a part of it fits");
}

#[test]
fn exactly_one_prim_renders() {
    let none = errors(&prepare(&[BALL, SKY, CAMERA]));
    assert!(
        none.contains("error[no-render]") && none.contains("Def(Render: (camera: \"/Camera\")"),
        "{none}"
    );
    let two = errors(&prepare(&[
        BALL,
        SKY,
        CAMERA,
        RENDER,
        "\"/More\": Def(Render: (camera: \"/Camera\")),\n",
    ]));
    assert!(two.contains("error[two-renders]: both `/Render` and `/More`"), "{two}");
    assert!(two.contains("scene.ron:6:") && two.contains("scene.ron:5:"), "{two}");
    let off = prepare(&[
        BALL,
        SKY,
        CAMERA,
        RENDER,
        "\"/M\": Def(active: false, Render: (camera: \"/Camera\")),\n",
    ]);
    assert_eq!(errors(&off), "");
}

#[test]
fn render_names_a_camera() {
    let text = errors(&prepare(&[
        BALL,
        SKY,
        CAMERA,
        "\"/Render\": Def(Render: (camera: \"/Ball\")),\n",
    ]));
    assert!(text.contains("error[no-camera]: `/Ball` has no `Camera`"), "{text}");
    assert!(
        text.contains("scene.ron:5:") && text.contains("prims with `Camera`: /Camera"),
        "{text}"
    );
    let class = "\"/C\": Class(Camera: ()), \"/Render\": Def(Render: (camera: \"/C\")),\n";
    let text = errors(&prepare(&[BALL, SKY, class]));
    assert!(
        text.contains("`/C` is not rendered") && text.contains("no prim has one"),
        "{text}"
    );
}

#[test]
fn the_camera_is_rigid_and_rebased() {
    let scene = "\"/Far\": Def(Transform: (translate: (10000, 0, 0), scale: (3, 3, 3)), children: {
        \"Ball\": Def(Sphere: ()),
        \"Eye\": Def(Camera: (fov: 90), Transform: (translate: (0, 0, 2)), LookAt: (target: (10000, 0, 0))),
    }),\n";
    let app = prepare(&[
        scene,
        SKY,
        "\"/Render\": Def(Render: (camera: \"/Far/Eye\"), Film: (resolution: (4, 4))),\n",
    ]);
    assert_eq!(errors(&app), "");
    let camera = app.world().resource::<CameraFrame>().0.clone();
    let ray = camera.ray(Vec2::splat(2.0), 0.0);
    assert!((ray.origin - Vec3::new(0.0, 0.0, 6.0)).length() < 1e-6, "{ray:?}");
    assert!((ray.direction + Vec3::Z).length() < 1e-6, "{ray:?}");
    let corner = camera.ray(Vec2::ZERO, 0.0).direction;
    assert!(
        (corner - Vec3::new(-1.0, 1.0, -1.0).normalize()).length() < 1e-6,
        "scale changes no angle: {corner}"
    );
}

#[test]
fn a_mirrored_camera_is_put_right() {
    let camera = "\"/Camera\": Def(Camera: (), Transform: (scale: (-1, 2, 3), rotate: (0, 90, 0))),\n";
    let app = prepare(&[BALL, SKY, camera, RENDER]);
    assert_eq!(errors(&app), "");
    let axes = app.world().resource::<CameraFrame>().0.frame.at(0.0).matrix3;
    assert!((axes.determinant() - 1.0).abs() < 1e-6);
    assert!((Vec3::from(axes.z_axis) - Vec3::X).length() < 1e-6, "{axes:?}");
}

#[test]
fn settings_without_effect_are_warnings() {
    let app = with_rest(&format!("{BALL}\"/A\": Def(Film: (), LightTransport: ()),\n"));
    assert_eq!(errors(&app), "");
    let text = warnings(&app);
    assert!(
        text.contains("`Film` of `/A` has no effect") && text.contains("`LightTransport` of `/A`"),
        "{text}"
    );
    let app = with_rest("\"/A\": Def(Quad: (), Dielectric: (thin: true, absorption: (1, 1, 1))),\n");
    assert!(
        warnings(&app).contains("`absorption` of a `thin` dielectric"),
        "{}",
        warnings(&app)
    );
}
