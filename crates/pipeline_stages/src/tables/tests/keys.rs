use super::{CAMERA, SKY, errors, prepare_with};
use pipeline_data::{ComposedScene, RenderSettings};

const BALL: &str = "\"/Ball\": Def(Sphere: (), Diffuse: ()),\n";
const RENDER: &str = "\"/Render\": Def(Render: (camera: \"/Camera\")),\n";
/// A ball that moves.
const MOVING: &str =
    "\"/Ball\": Def(Sphere: (), Diffuse: (), Transform: (translate: Samples({0: (0, 0, 0), 9: (1, 0, 0)}))),\n";

/// The key of the light of a scene at a frame.
fn at_frame(prims: &[&str], frame: Option<f64>) -> [u8; 32] {
    let app = prepare_with(prims, |request| request.options.frame = frame);
    assert_eq!(errors(&app), "");
    let world = app.world();
    let scene = &world.resource::<ComposedScene>().0;
    world.resource::<RenderSettings>().light_key(scene, "test")
}

fn light(prims: &[&str]) -> [u8; 32] {
    at_frame(prims, None)
}

#[test]
fn the_view_does_not_count_in_the_key_of_light() {
    let plain = light(&[BALL, SKY, CAMERA, RENDER]);
    for camera in [
        "\"/Camera\": Def(Camera: (fov: 20), Transform: (translate: (0, 1, 6)), LookAt: (target: (0, 0, 0))),\n",
        "\"/Camera\": Def(Camera: (), DepthOfField: (lens_radius: 0.1, focus_distance: 4)),\n",
        "\"/Camera\": Def(Camera: (), MotionBlur: (shutter: (0, 0.5))),\n",
        "\"/Camera\": Def(Camera: (), Transform: (translate: Samples({0: (0, 0, 5), 9: (1, 0, 5)}))),\n",
        "\"/Camera\": Def(Camera: (), Transform: (translate: (0, 0, 5))), \"/Spare\": Def(Camera: ()),\n",
    ] {
        assert_eq!(light(&[BALL, SKY, camera, RENDER]), plain, "{camera}");
    }
    for render in [
        "\"/Render\": Def(Render: (camera: \"/Camera\", samples: 3, passes: 3)),\n",
        "\"/Render\": Def(Render: (camera: \"/Camera\"), Film: (resolution: (8, 4), exposure: 2, filter: Box)),\n",
    ] {
        assert_eq!(light(&[BALL, SKY, CAMERA, render]), plain, "{render}");
    }
    let rig = "\"/Rig\": Def(Transform: (translate: (1, 1, 5)), children: {\"Eye\": Def(Camera: ())}),\n";
    let render = "\"/Render\": Def(Render: (camera: \"/Rig/Eye\")),\n";
    assert_eq!(light(&[BALL, SKY, rig, render]), plain);
    // A frame is a view of a scene in which nothing but the camera moves.
    assert_eq!(at_frame(&[BALL, SKY, CAMERA, RENDER], Some(4.0)), plain);
}

#[test]
fn all_else_counts_in_the_key_of_light() {
    let plain = light(&[BALL, SKY, CAMERA, RENDER]);
    let with_camera = |camera: &str| light(&[BALL, SKY, camera, RENDER]);
    let with_render = |render: &str| light(&[BALL, SKY, CAMERA, render]);
    let ball = "\"/Ball\": Def(Sphere: (radius: 0.9), Diffuse: ()),\n";
    let others = [
        light(&[ball, SKY, CAMERA, RENDER]),
        light(&[BALL, CAMERA, RENDER, "\"/Sky\": Def(EnvironmentLight: (scale: 2)),\n"]),
        with_render("\"/Render\": Def(Render: (camera: \"/Camera\", max_depth: 4)),\n"),
        with_render("\"/Render\": Def(Render: (camera: \"/Camera\", seed: 4)),\n"),
        with_render("\"/Render\": Def(Render: (camera: \"/Camera\"), IrradianceCache: (rays: 99)),\n"),
        with_render("\"/Render\": Def(Render: (camera: \"/Camera\"), LightTransport: (direct: Off)),\n"),
    ];
    for (i, other) in others.iter().enumerate() {
        assert_ne!(*other, plain, "{i}");
    }
    // What hangs on a camera moves along.
    let lamp = |x: u32| {
        format!(
            "\"/Camera\": Def(Camera: (), Transform: (translate: ({x}, 0, 5)), children: {{\"Lamp\": Def(PointLight: ())}}),\n"
        )
    };
    assert_ne!(with_camera(&lamp(0)), with_camera(&lamp(1)));
}

#[test]
fn where_things_move_time_counts_in_the_key_of_light() {
    let prims = [MOVING, SKY, CAMERA, RENDER];
    assert_eq!(at_frame(&prims, Some(4.0)), at_frame(&prims, Some(4.0)));
    assert_ne!(at_frame(&prims, Some(4.0)), at_frame(&prims, Some(5.0)));
    let open = |frames: u32| format!("\"/Camera\": Def(Camera: (), MotionBlur: (shutter: (0, {frames}))),\n");
    assert_ne!(
        light(&[MOVING, SKY, &open(1), RENDER]),
        light(&[MOVING, SKY, &open(2), RENDER])
    );
}
