use crate::DefaultStages;
use bevy_app::App;
use glam::{DAffine3, DVec3, Vec3};
use pipeline_core::{CorePlugin, Load, Prepare, Report};
use pipeline_data::{
    ComposedScene, InstancePrims, PrimIndex, RenderRequest, SceneOrigin, TransportScene, WorldMotion, WorldTransform,
};
use spatial::Ray;

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2//1 3//1 4//1\n";

/// Prepares a scene with these prims, a lamp and a camera.
fn prepare(prims: &str) -> App {
    prepare_seen_by("", prims)
}

/// - `eye`: components beside that of the camera.
fn prepare_seen_by(eye: &str, prims: &str) -> App {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("scene.ron");
    let text = format!(
        "Layer(prims: {{\n{prims}\n\
         \"/Sky\": Def(EnvironmentLight: ()), \"/Camera\": Def(Camera: (){eye}),\n\
         \"/Render\": Def(Render: (camera: \"/Camera\"), Film: (resolution: (4, 4)))}})"
    );
    std::fs::write(&scene, text).unwrap();
    std::fs::write(folder.path().join("quad.obj"), QUAD).unwrap();
    let mut app = App::empty();
    app.add_plugins((CorePlugin, DefaultStages));
    app.insert_resource(RenderRequest {
        scene,
        ..RenderRequest::default()
    });
    app.world_mut().run_schedule(Load);
    assert_eq!(errors(&app), "", "while loading");
    app.world_mut().run_schedule(Prepare);
    app
}

fn errors(app: &App) -> String {
    app.world().resource::<Report>().errors().join("\n")
}

fn world_transform(app: &mut App, path: &str) -> DAffine3 {
    let world = app.world_mut();
    let row = world.resource::<ComposedScene>().0.index_of(path).unwrap() as u32;
    let mut query = world.query::<(&PrimIndex, &WorldTransform)>();
    query.iter(world).find(|(index, _)| index.0 == row).unwrap().1.0
}

/// World transform of `/A` or what is below it, when these are all prims.
fn placed(prims: &str, path: &str) -> DAffine3 {
    let mut app = prepare(prims);
    assert_eq!(errors(&app), "");
    world_transform(&mut app, path)
}

fn assert_near(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-12 * (1.0 + b.length()), "{a} against {b}");
}

#[test]
fn parents_come_before_children() {
    let placed = placed(
        r#""/A": Def(Transform: (translate: (1, 2, 3), rotate: (0, 90, 0)), children: {
            "B": Def(children: {"C": Def(Sphere: (), Transform: (translate: (1, 0, 0), scale: (2, 2, 2)))}),
        }),"#,
        "/A/B/C",
    );
    assert_eq!(placed.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 2.0));
    assert_eq!(placed.transform_point3(DVec3::X), DVec3::new(1.0, 2.0, 0.0));
}

#[test]
fn angles_turn_about_x_first_and_z_last() {
    let turned = |rotate: &str| {
        placed(
            &format!(r#""/A": Def(Sphere: (), Transform: (rotate: {rotate})),"#),
            "/A",
        )
    };
    assert_near(turned("(90, 0, 90)").transform_vector3(DVec3::Y), DVec3::Z);
    assert_near(turned("(90, 90, 0)").transform_vector3(DVec3::Y), DVec3::X);
    assert_near(turned("(0, 90, 90)").transform_vector3(DVec3::X), -DVec3::Z);
    let third = turned("(0, 0, 30)").transform_vector3(DVec3::X);
    assert_near(third, DVec3::new(0.75_f64.sqrt(), 0.5, 0.0));
    assert_near(turned("(0, 0, -690)").transform_vector3(DVec3::X), third);
    for quarter in ["90", "180", "270", "-90", "450"] {
        let axis = turned(&format!("({quarter}, 0, 0)")).transform_vector3(DVec3::Y);
        assert!(
            axis.to_array().iter().all(|x| [0.0, 1.0].contains(&x.abs())),
            "{quarter}: {axis}"
        );
    }
}

#[test]
fn quaternions_and_matrices_stand_for_the_rest() {
    let half = placed(
        r#""/A": Def(Sphere: (), Transform: (quaternion: (0, 0, 3, 3), scale: (2, 1, 1))),"#,
        "/A",
    );
    assert_near(half.transform_vector3(DVec3::X), 2.0 * DVec3::Y);
    let matrix = "(0,2,0,0, -1,0,0,0, 0,0,1,0, 5,6,7,1)";
    let matrix = placed(
        &format!(r#""/A": Def(Sphere: (), Transform: (matrix: {matrix})),"#),
        "/A",
    );
    assert_near(matrix.transform_point3(DVec3::X), DVec3::new(5.0, 8.0, 7.0));
}

#[test]
fn look_at_ignores_the_orientation_of_parents_but_not_their_place() {
    let placed = placed(
        r#""/A": Def(Transform: (translate: (0, 1, 0), rotate: (10, 20, 30), scale: (3, 3, 3)), children: {
            "B": Def(Sphere: (), LookAt: (target: (4, 1, 0)), Transform: (scale: (1, 2, 5))),
        }),"#,
        "/A/B",
    );
    assert_near(placed.translation, DVec3::Y);
    assert_near(placed.transform_vector3(-DVec3::Z), 5.0 * DVec3::X);
    assert_near(placed.transform_vector3(DVec3::Y), 2.0 * DVec3::Y);
    assert_near(placed.transform_vector3(DVec3::X), DVec3::Z);
}

#[test]
fn mirrored_things_keep_their_outside() {
    let app = prepare(r#""/A": Def(Sphere: (), Transform: (scale: (-1, 2, 1))),"#);
    assert_eq!(errors(&app), "");
    let rays = &app.world().resource::<TransportScene>().0.rays;
    let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let point = rays.surface(&ray, &rays.intersect(&ray).unwrap());
    assert!(
        (point.p + Vec3::X).length() < 1e-6 && (point.ng + Vec3::X).length() < 1e-6,
        "{point:?}"
    );
}

#[test]
fn a_scene_ten_kilometres_away_keeps_its_precision() {
    let scene = |x: f64| {
        let prims = format!(
            r#""/A": Def(Transform: (translate: ({x}, 0, 0)), children: {{
                "B": Def(Sphere: (radius: 0.001), Transform: (translate: (0.0005, 0, 0))),
                "C": Def(Mesh: (file: "quad.obj"), Transform: (translate: (0, 1, 0), scale: (0.01, 0.01, 1))),
            }}),"#
        );
        let app = prepare(&prims);
        assert_eq!(errors(&app), "");
        let origin = app.world().resource::<SceneOrigin>().0;
        assert!((origin.x - x).abs() < 1.0, "{origin}");
        let rays = &app.world().resource::<TransportScene>().0.rays;
        [0, 1].map(|instance| rays.instance_bounds(instance))
    };
    for (near, far) in scene(0.0).iter().zip(scene(10_000.0)) {
        // Double precision leaves 2e-12 m at this distance; single precision would leave 1e-3 m.
        assert!((near.min - far.min).abs().max_element() < 1e-9, "{near:?} {far:?}");
        assert!((near.max - far.max).abs().max_element() < 1e-9, "{near:?} {far:?}");
    }
}

#[test]
fn instances_follow_the_order_of_the_scene_and_share_meshes() {
    let app = prepare(
        r#""/Z": Def(Sphere: ()), "/A": Def(Mesh: (file: "quad.obj"), Transform: (translate: (5, 0, 0))),
        "/B": Def(Mesh: (file: "quad.obj", smooth: false), Transform: (translate: (8, 0, 0))),"#,
    );
    assert_eq!(errors(&app), "");
    let scene = &app.world().resource::<ComposedScene>().0;
    let prims = &app.world().resource::<InstancePrims>().0;
    let paths: Vec<&str> = prims
        .iter()
        .map(|row| scene.prims[*row as usize].path.as_str())
        .collect();
    assert_eq!(paths, ["/Z", "/A", "/B"]);
    let (rays, origin) = (
        &app.world().resource::<TransportScene>().0.rays,
        app.world().resource::<SceneOrigin>().0.as_vec3(),
    );
    let normal_at = |x: f32| {
        let ray = Ray::new(Vec3::new(x, 0.3, 5.0) - origin, -Vec3::Z);
        rays.surface(&ray, &rays.intersect(&ray).unwrap()).ns
    };
    assert!(normal_at(5.5).x > 0.5, "the file's normals shade the first");
    assert!((normal_at(8.5) - Vec3::Z).length() < 1e-6, "and not the second");
}

#[test]
fn transforms_that_cannot_be_are_refused_with_their_place() {
    for (bad, code, place) in [
        ("Transform: (scale: (1, 0, 1))", "singular-transform", "(1, 0, 1)"),
        ("Transform: (scale: (1, 1e-200, 1))", "singular-transform", "1e-200"),
        (
            "Transform: (matrix: (1,0,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1))",
            "singular-transform",
            "1,0,0,0",
        ),
        (
            "Transform: (matrix: (1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2))",
            "bad-matrix",
            "0,0,0,2",
        ),
        (
            "Transform: (matrix: (1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1), scale: (2, 2, 2))",
            "exclusive-fields",
            "matrix",
        ),
        ("Transform: (quaternion: (0, 0, 0, 0))", "bad-rotation", "(0, 0, 0, 0)"),
        ("LookAt: (target: (0, 0, 0))", "bad-look-at", "lies where it looks"),
        ("LookAt: (target: (0, 5, 0))", "bad-look-at", "looks along its `up`"),
        (
            "LookAt: (target: (1, 0, 0), up: (0, 0, 0))",
            "bad-look-at",
            "looks along its `up`",
        ),
        (
            "Transform: (translate: (1e300, 0, 0), scale: (1e300, 1e300, 1e300))",
            "",
            "/A",
        ),
    ] {
        let app = prepare(&format!("\"/A\": Def(Sphere: (), {bad}),\n"));
        let text = errors(&app);
        assert!(
            text.contains(&format!("error[{code}")) && text.contains(place),
            "{bad}: {text}"
        );
        assert!(text.contains("scene.ron:2:"), "{bad}: {text}");
        assert!(!app.world().contains_resource::<TransportScene>());
    }
}

#[test]
fn a_bad_parent_is_reported_once() {
    let app = prepare(
        r#""/A": Def(Transform: (scale: (0, 1, 1)), children: {"B": Def(Sphere: ()), "C": Def(LookAt: (target: (0, 0, 1)))}),"#,
    );
    let report = app.world().resource::<Report>();
    assert_eq!(report.errors().len(), 1, "{:?}", report.errors());
}

#[test]
fn all_errors_are_shown_up_to_twenty() {
    let prims: String = (0..25)
        .map(|i| format!("\"/A{i}\": Def(Transform: (scale: (0, 1, 1))),\n"))
        .collect();
    let app = prepare(&prims);
    let report = app.world().resource::<Report>();
    assert_eq!(report.errors().len(), 21);
    assert_eq!(report.errors()[20], "and 5 more errors\n");
}

#[test]
fn impossible_geometry_is_refused_with_its_place() {
    let app = prepare(
        "\"/A\": Def(Torus: (minor_radius: 2)),\n\"/B\": Def(Sphere: ()),\n\"/C\": Def(Band: (outer_radius: 0.5)),\n\
         \"/D\": Def(Sphere: (radius: 1e38), Transform: (scale: (1e38, 1e38, 1e38))),\n",
    );
    let errors = app.world().resource::<Report>().errors();
    assert_eq!(errors.len(), 3, "{errors:?}");
    assert!(
        errors[0].contains("error[bad-shape]: `/A`") && errors[0].contains("scene.ron:2:"),
        "{}",
        errors[0]
    );
    assert!(
        errors[1].contains("error[bad-shape]: `/C`") && errors[1].contains("scene.ron:4:"),
        "{}",
        errors[1]
    );
    assert!(
        errors[2].contains("error[too-far]: `/D`") && errors[2].contains("bring it nearer"),
        "{}",
        errors[2]
    );
}

#[test]
fn what_rounding_swallows_is_a_warning() {
    let near = prepare("\"/A\": Def(Sphere: ()), \"/B\": Def(Sphere: (), Transform: (translate: (1e5, 0, 0))),\n");
    assert_eq!(near.world().resource::<Report>().warnings(), [""; 0]);
    let far = prepare(
        "\"/A\": Def(Sphere: ()),\n\"/B\": Def(Sphere: ()),\n\"/C\": Def(Sphere: (), Transform: (translate: (1e9, 0, 0))),\n",
    );
    assert_eq!(errors(&far), "");
    let warnings = far.world().resource::<Report>().warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(
        warnings[0].contains("warning[lost-in-rounding]: `/A`") && warnings[0].contains("2 others"),
        "{}",
        warnings[0]
    );
}

#[test]
fn a_prim_has_one_geometry() {
    let app = prepare("\"/A\": Def(\n  Sphere: (),\n  Cuboid: (),\n),\n");
    let text = errors(&app);
    assert!(
        text.contains("error[two-geometries]: `/A` has two geometries, `Sphere` and `Cuboid`"),
        "{text}"
    );
    assert!(text.contains("scene.ron:4:") && text.contains("scene.ron:3:"), "{text}");
}

#[test]
fn whole_turns_while_the_shutter_is_open_are_seen() {
    let keys = |samples: &str| {
        let moving = format!("\"/A\": Def(Sphere: (), Transform: (rotate: Samples({{{samples}}}))),");
        let mut app = prepare_seen_by(", MotionBlur: (shutter: (0, 1))", &moving);
        assert_eq!(errors(&app), "");
        let world = app.world_mut();
        let mut motions = world.query::<&WorldMotion>();
        motions.single(world).unwrap().0.len()
    };
    let almost = keys("0: (0, 0, 0), 1: (0, 719, 0)");
    assert!(almost > 100, "{almost}");
    assert_eq!(keys("0: (0, 0, 0), 1: (0, 720, 0)"), almost);
    // There and back within a sixteenth of the time, and still before and after.
    assert!(keys("0.4: (0, 0, 0), 0.43: (0, 10, 0), 0.46: (0, 0, 0)") > 30);
}
