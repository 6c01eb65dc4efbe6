//! What the command line says.

use insta::assert_snapshot;
use scene_format::Options;

use crate::vocabulary::{load_with, options, set_errors};

const SCENE: &str = "Layer(prims: {\"/W\": Def(Camera: (fov: 35), Film: (), LightLinks: (exclude: [\"/W\"]))})";

#[test]
fn later_flags_win_over_the_scene() {
    let options = Options {
        sets: [
            "/W.Camera.fov=1",
            "/W.fov = 2 // two",
            "/W.Emission.power=(1, 2, 3)",
            "/W.LightLinks.exclude=Edit(delete: [\"/W\"])",
        ]
        .map(str::to_owned)
        .to_vec(),
        ..options()
    };
    let scene = load_with(SCENE, &options).unwrap();
    let prim = scene.prim("/W").unwrap();
    let fov = prim.component("Camera").unwrap().field("fov").unwrap();
    assert_eq!(fov.get_at::<f32>(0.0), Some(2.0));
    let opinions: Vec<(bool, &str)> = fov
        .opinions
        .iter()
        .map(|opinion| {
            let session = scene.sources.is_argument(opinion.place.source);
            (session, scene.sources.text(opinion.place))
        })
        .collect();
    assert_eq!(opinions, [(true, "2"), (false, "35")]);
    assert_eq!(scene.sources.describe(fov.place).to_string(), "--set");
    assert!(prim.component("Emission").is_some());
    let links = prim.component("LightLinks").unwrap().field("exclude").unwrap();
    assert_eq!(links.get_at(0.0), Some(scene_format::Targets(Vec::new())));
}

#[test]
fn says_what_is_wrong_with_an_argument() {
    assert_snapshot!(set_errors(SCENE, &["/V.Camera.fov=2"]), @r#"
    error[unknown-prim]: there is no prim `/V`
      --> --set
       |
       | /V.Camera.fov=2
       | ^^ did you mean `/W`?
    "#);
    assert_snapshot!(set_errors(SCENE, &["/W.Camra.fov=2"]), @r#"
    error[unknown-component]: there is no component `Camra`
      --> --set
       |
       | /W.Camra.fov=2
       |    ^^^^^ did you mean `Camera`?
    "#);
    assert_snapshot!(set_errors(SCENE, &["/W.Camera.fvo=2"]), @r#"
    error[unknown-field]: `Camera` has no field `fvo`
      --> --set
       |
       | /W.Camera.fvo=2
       |           ^^^ did you mean `fov`?
       = fields of Camera: fov, fstop (pipeline schema Camera)
    "#);
    assert_snapshot!(set_errors(SCENE, &["/W.fvo=2"]), @r#"
    error[unknown-field]: no component of `/W` has a field `fvo`
      --> --set
       |
       | /W.fvo=2
       |    ^^^ did you mean `fov`?
       = components of /W: Camera, Film, LightLinks
    "#);
    assert_snapshot!(set_errors(SCENE, &["/W.Camera.fov=wide"]), @r#"
    error[wrong-type]: `Camera.fov` must be a number
      --> --set
       |
       | /W.Camera.fov=wide
       |               ^^^^
    "#);
    assert_snapshot!(set_errors(SCENE, &["/W.Camera.fov="]), @r#"
    error[bad-set]: there is no value after `=`
      --> --set
       |
       | /W.Camera.fov=
       |               ^
    "#);
    assert_snapshot!(set_errors(SCENE, &["/W.Camera.fov"]), @r#"
    error[bad-set]: this must be `/Prim.Component.field=value` or `/Prim.field=value`
      --> --set
       |
       | /W.Camera.fov
       | ^^^^^^^^^^^^^
    "#);
    assert_snapshot!(set_errors(SCENE, &["fov=2"]), @r#"
    error[bad-set]: this must be `/Prim.Component.field=value` or `/Prim.field=value`
      --> --set
       |
       | fov=2
       | ^^^
    "#);
    let two = "Layer(prims: {\"/W\": Def(Mesh: (file: \"a\"), LookAt: (target: (0, 0, 0)), Render: (camera: \"/W\", seed: 1), Transform: (), Conductor: ())})";
    assert_snapshot!(set_errors(two, &["/W.nothing=2"]), @r#"
    error[unknown-field]: no component of `/W` has a field `nothing`
      --> --set
       |
       | /W.nothing=2
       |    ^^^^^^^
       = components of /W: Conductor, LookAt, Mesh, Render, Transform
    "#);
    let both = "Layer(prims: {\"/W\": Def(Emission: (), EnvironmentLight: ())})";
    assert_snapshot!(set_errors(both, &["/W.radiance=(1, 2, 3)"]), @r#"
    error[ambiguous-field]: `/W` has 2 components with a field `radiance`
      --> --set
       |
       | /W.radiance=(1, 2, 3)
       |    ^^^^^^^^
       = write /W.Emission.radiance or /W.EnvironmentLight.radiance
    "#);
}

#[test]
fn checks_variants() {
    let scene = "Layer(prims: {\"/W\": Def(variants: {\"metal\": {\"gold\": (), \"silver\": ()}})})";
    let errors = |variant: &str| {
        let options = Options {
            variants: vec![variant.to_owned()],
            ..options()
        };
        let list = load_with(scene, &options).map_or_else(|errors| errors.list, |_| Vec::new());
        list.iter().map(|error| error.code).collect::<Vec<_>>()
    };
    assert_eq!(errors("/W{metl=gold}"), ["unknown-variant-set"]);
    assert_eq!(errors("/W{metal=glod}"), ["unknown-variant"]);
    assert_eq!(errors("/V{metal=gold}"), ["unknown-prim"]);
    assert!(errors("/W{metal=gold}").is_empty());
    assert_eq!(errors("/W.metal"), ["bad-variant"]);
}
