//! Whole messages, as people read them.

use insta::assert_snapshot;

use crate::vocabulary::errors;

#[test]
fn unknown_names() {
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(\n        Camra: (fov: 1.0),\n    ),\n})\n"
    ), @r#"
    error[unknown-component]: there is no component `Camra`
      --> scene.ron:3:9
       |
     3 |         Camra: (fov: 1.0),
       |         ^^^^^ did you mean `Camera`?
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Camera: (fov: 1.0, fstp: 2.0)),\n})\n"
    ), @r#"
    error[unknown-field]: `Camera` has no field `fstp`
      --> scene.ron:2:34
       |
     2 |     "/W": Def(Camera: (fov: 1.0, fstp: 2.0)),
       |                                  ^^^^ did you mean `fstop`?
       = fields of Camera: fov, fstop (pipeline schema Camera)
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(Marker: (size: 1.0)),\n})\n"), @r#"
    error[unknown-field]: `Marker` has no field `size`
      --> scene.ron:2:24
       |
     2 |     "/W": Def(Marker: (size: 1.0)),
       |                        ^^^^
       = Marker has no fields (pipeline schema Marker)
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(reference: [\"a.ron\"]),\n})\n"), @r#"
    error[unknown-keyword]: a prim has no field `reference`
      --> scene.ron:2:15
       |
     2 |     "/W": Def(reference: ["a.ron"]),
       |               ^^^^^^^^^ did you mean `references`?
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(colour: 3),\n})\n"), @r#"
    error[unknown-keyword]: a prim has no field `colour`
      --> scene.ron:2:15
       |
     2 |     "/W": Def(colour: 3),
       |               ^^^^^^
       = fields of a prim: type, doc, active, references, payloads, inherits, specializes, select, variants, without, order, children; components begin with a capital letter
    "#);
    assert_snapshot!(errors("Layer(\n    prim: {},\n)\n"), @r#"
    error[unknown-keyword]: a layer has no field `prim`
      --> scene.ron:2:5
       |
     2 |     prim: {},
       |     ^^^^ did you mean `prims`?
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Deff(),\n})\n"), @r#"
    error[unknown-keyword]: `Deff` is not a kind of prim
      --> scene.ron:2:11
       |
     2 |     "/W": Deff(),
       |           ^^^^ did you mean `Def`?
       = kinds of prims: Def, Over, Class
    "#);
}

#[test]
fn wrong_values() {
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Over(Camera: (fov: \"wide\")),\n})\n"
    ), @r#"
    error[wrong-type]: `Camera.fov` must be a number
      --> scene.ron:2:30
       |
     2 |     "/W": Over(Camera: (fov: "wide")),
       |                              ^^^^^^
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Diffuse: (albedo: (1, \"a\", 2))),\n})\n"
    ), @r#"
    error[wrong-type]: `Diffuse.albedo` must be 3 numbers
      --> scene.ron:2:37
       |
     2 |     "/W": Def(Diffuse: (albedo: (1, "a", 2))),
       |                                     ^^^
       = written as `(1, 2, 3)`
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Diffuse: (albedo: (1, 1))),\n})\n"
    ), @r#"
    error[wrong-type]: `Diffuse.albedo` must be 3 numbers
      --> scene.ron:2:38
       |
     2 |     "/W": Def(Diffuse: (albedo: (1, 1))),
       |                                      ^
       = written as `(1, 2, 3)`
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(Film: (filter: Bx)),\n})\n"), @r#"
    error[wrong-type]: `Film.filter` must be one of Box, Triangle, BlackmanHarris
      --> scene.ron:2:30
       |
     2 |     "/W": Def(Film: (filter: Bx)),
       |                              ^^ did you mean `Box`?
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Film: (filter: \"Box\")),\n})\n"
    ), @r#"
    error[wrong-type]: `Film.filter` must be one of Box, Triangle, BlackmanHarris
      --> scene.ron:2:30
       |
     2 |     "/W": Def(Film: (filter: "Box")),
       |                              ^^^^^ did you mean `Box`?
       = values that the program knows are written without quotes
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Film: (resolution: (-1, 3))),\n})\n"
    ), @r#"
    error[wrong-type]: `Film.resolution` must be 2 whole numbers from 0
      --> scene.ron:2:37
       |
     2 |     "/W": Def(Film: (resolution: (-1, 3))),
       |                                     ^
       = written as `(1, 2)`
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(Camera: (fov: 1..3)),\n})\n"), @r#"
    error[wrong-type]: `Camera.fov` must be a number
      --> scene.ron:2:29
       |
     2 |     "/W": Def(Camera: (fov: 1..3)),
       |                             ^^^^
       = ranges of numbers are not values
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(Camera: 35),\n})\n"), @r#"
    error[syntax]: expected `(`, found `35`
      --> scene.ron:2:23
       |
     2 |     "/W": Def(Camera: 35),
       |                       ^^
       = fields are written `(name: value, ..)`
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(active: 1, without: \"Camera\"),\n})\n"
    ), @r#"
    error[wrong-type]: `active` must be `true` or `false`
      --> scene.ron:2:23
       |
     2 |     "/W": Def(active: 1, without: "Camera"),
       |                       ^

    error[wrong-type]: this must be a list of names in quotes
      --> scene.ron:2:35
       |
     2 |     "/W": Def(active: 1, without: "Camera"),
       |                                   ^^^^^^^^
    "#);
    assert_snapshot!(errors("Layer(version: 2, time: (start: 2, end: 1))\n"), @r#"
    error[unknown-version]: this is a scene of version 2; 1 can be read
      --> scene.ron:1:16
       |
     1 | Layer(version: 2, time: (start: 2, end: 1))
       |                ^

    error[out-of-range]: the scene ends before it starts
      --> scene.ron:1:25
       |
     1 | Layer(version: 2, time: (start: 2, end: 1))
       |                         ^^^^^^^^^^^^^^^^^^
    "#);
}

#[test]
fn numbers_out_of_range() {
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(Camera: (fov: 180)),\n})\n"), @r#"
    error[out-of-range]: `Camera.fov` must be above 0 and below 180 degrees, but is 180
      --> scene.ron:2:29
       |
     2 |     "/W": Def(Camera: (fov: 180)),
       |                             ^^^
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Diffuse: (albedo: (0.5, 1.5, 0))),\n})\n"
    ), @r#"
    error[out-of-range]: `Diffuse.albedo` must be 0 to 1, but is 1.5
      --> scene.ron:2:33
       |
     2 |     "/W": Def(Diffuse: (albedo: (0.5, 1.5, 0))),
       |                                 ^^^^^^^^^^^^^
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Camera: (fov: NaN, fstop: inf)),\n})\n"
    ), @r#"
    error[not-finite]: `Camera.fov` must be finite, at most 3.4e38
      --> scene.ron:2:29
       |
     2 |     "/W": Def(Camera: (fov: NaN, fstop: inf)),
       |                             ^^^

    error[not-finite]: `Camera.fstop` must be finite, at most 3.4e38
      --> scene.ron:2:41
       |
     2 |     "/W": Def(Camera: (fov: NaN, fstop: inf)),
       |                                         ^^^
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(Camera: (fov: 1e99)),\n})\n"), @r#"
    error[not-finite]: `Camera.fov` must be finite, at most 3.4e38
      --> scene.ron:2:29
       |
     2 |     "/W": Def(Camera: (fov: 1e99)),
       |                             ^^^^
    "#);
}

#[test]
fn things_written_twice() {
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Camera: (fov: 1.0, fov: 2.0)),\n})\n"
    ), @r#"
    error[duplicate-field]: `fov` is written twice
      --> scene.ron:2:34
       |
     2 |     "/W": Def(Camera: (fov: 1.0, fov: 2.0)),
       |                                  ^^^
       = first written: scene.ron:2:24
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(),\n    \"/W\": Over(),\n})\n"), @r#"
    error[duplicate-prim]: `/W` is written twice
      --> scene.ron:3:6
       |
     3 |     "/W": Over(),
       |      ^^
       = first written: scene.ron:2:6
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(children: {\"K\": Def()}),\n    \"/W/K\": Over(active: false),\n})\n"
    ), @r#"
    error[duplicate-prim]: `/W/K` is written twice in this file
      --> scene.ron:3:6
       |
     3 |     "/W/K": Over(active: false),
       |      ^^^^
       = first written: scene.ron:2:27
       = put everything that a file says about a prim in one place
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Camera: (fov: Samples({1: 1.0, 1.0: 2.0}))),\n})\n"
    ), @r#"
    error[duplicate-sample]: there are two samples at time 1
      --> scene.ron:2:46
       |
     2 |     "/W": Def(Camera: (fov: Samples({1: 1.0, 1.0: 2.0}))),
       |                                              ^^^
       = first written: scene.ron:2:38
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Emission: (radiance: (1, 1, 1), power: (2, 2, 2))),\n})\n"
    ), @r#"
    error[exclusive-fields]: `Emission` cannot have both `radiance` and `power`
      --> scene.ron:2:54
       |
     2 |     "/W": Def(Emission: (radiance: (1, 1, 1), power: (2, 2, 2))),
       |                                                      ^^^^^^^^^
       = `radiance` is written: scene.ron:2:36
       = to use `power`, write `Emission: (radiance: Block)` where it should win
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Conductor: (metal: \"gold\", eta: (1, 1, 1), k: (2, 2, 2))),\n})\n"
    ), @r#"
    error[exclusive-fields]: `Conductor` cannot have both `metal` and `eta`
      --> scene.ron:2:47
       |
     2 |     "/W": Def(Conductor: (metal: "gold", eta: (1, 1, 1), k: (2, 2, 2))),
       |                                               ^^^^^^^^^
       = `metal` is written: scene.ron:2:34
       = to use `eta`, write `Conductor: (metal: Block)` where it should win
    "#);
}

#[test]
fn things_missing() {
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(LookAt: (up: (0, 1, 0))),\n})\n"
    ), @r#"
    error[missing-field]: `LookAt` needs the field `target`
      --> scene.ron:2:15
       |
     2 |     "/W": Def(LookAt: (up: (0, 1, 0))),
       |               ^^^^^^
       = pipeline schema LookAt
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(Conductor: (eta: (1, 1, 1))),\n})\n"
    ), @r#"
    error[missing-field]: `eta` needs `k` too
      --> scene.ron:2:32
       |
     2 |     "/W": Def(Conductor: (eta: (1, 1, 1))),
       |                                ^^^^^^^^^
    "#);
    assert_snapshot!(errors("Layer(default_prim: \"V\", prims: {\"/W\": Def()})\n"), @r#"
    error[missing-prim]: `default_prim` names `/V`, which is not here
      --> scene.ron:1:22
       |
     1 | Layer(default_prim: "V", prims: {"/W": Def()})
       |                      ^
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/Camera\": Def(),\n    \"/Render\": Def(Render: (camera: \"/Camra\")),\n})\n"
    ), @r#"
    error[unknown-target]: there is no prim `/Camra`
      --> scene.ron:3:38
       |
     3 |     "/Render": Def(Render: (camera: "/Camra")),
       |                                      ^^^^^^ did you mean `/Camera`?
    "#);
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(LightLinks: (exclude: [\"../../..\"])),\n})\n"
    ), @r#"
    error[bad-path]: `../../..` climbs above the root of the scene
      --> scene.ron:2:39
       |
     2 |     "/W": Def(LightLinks: (exclude: ["../../.."])),
       |                                       ^^^^^^^^
    "#);
}

#[test]
fn bad_names() {
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(children: {\"two words\": Def()}),\n})\n"
    ), @r#"
    error[bad-name]: `two words` is not a name; names are letters, digits and `_`, not beginning with a digit
      --> scene.ron:2:27
       |
     2 |     "/W": Def(children: {"two words": Def()}),
       |                           ^^^^^^^^^
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"W\": Def(),\n})\n"), @r#"
    error[bad-name]: `W` is not an absolute path; paths begin with `/`
      --> scene.ron:2:6
       |
     2 |     "W": Def(),
       |      ^
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\\u{41}\": Def(),\n})\n"), @r#"
    error[bad-name]: a name cannot contain `\`
      --> scene.ron:2:15
       |
     2 |     "/W\u{41}": Def(),
       |               ^
    "#);
}

#[test]
fn syntax() {
    assert_snapshot!(errors(
        "Layer(prims: {\n    \"/W\": Def(\n        Camera: (fov: 1.0)\n        Film: (),\n    ),\n})\n"
    ), @r#"
    error[syntax]: expected a comma, found `Film`
      --> scene.ron:4:9
       |
     4 |         Film: (),
       |         ^^^^
       = is a comma missing before this, or a bracket not closed?
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": Def(\n"), @r#"
    error[syntax]: the file ends too early
      --> scene.ron:3:1
       |
     3 |
       | ^
       = this `(` is never closed: scene.ron:2:14
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    W: Def(),\n})\n"), @r#"
    error[syntax]: expected a text in quotes, found `W`
      --> scene.ron:2:5
       |
     2 |     W: Def(),
       |     ^
       = names that you invent are quoted: `"/World": Def(..)`
    "#);
    assert_snapshot!(errors("Layer(prims: {\n    \"/W\": (),\n})\n"), @r#"
    error[syntax]: expected a name without quotes, found `(`
      --> scene.ron:2:11
       |
     2 |     "/W": (),
       |           ^
       = names the program knows are bare: `Def`, `children`, `Camera`
    "#);
    assert_snapshot!(errors("Layer())\n"), @r#"
    error[syntax]: nothing can follow the end of `Layer(..)`, found `)`
      --> scene.ron:1:8
       |
     1 | Layer())
       |        ^
       = is a closing bracket too many before this?
    "#);
    assert_snapshot!(errors("Scene()\n"), @r#"
    error[syntax]: expected `Layer`, found `Scene`
      --> scene.ron:1:1
       |
     1 | Scene()
       | ^^^^^
    "#);
    assert_snapshot!(errors("Layer(doc: \"never closed)\n"), @r#"
    error[syntax]: a text in quotes is never closed
      --> scene.ron:1:13
       |
     1 | Layer(doc: "never closed)
       |             ^^^^^
    "#);
    assert_snapshot!(errors("#![enable(everything)]\nLayer()\n"), @r#"
    error[syntax]: there is no RON extension `everything`
      --> scene.ron:1:11
       |
     1 | #![enable(everything)]
       |           ^^^^^^^^^^
       = `#![enable(implicit_some)]` is the one that scenes use, and it is on anyway
    "#);
    assert_snapshot!(errors(" // nothing\n"), @r#"
    error[syntax]: the file is empty
      --> scene.ron:1:1
       |
     1 |  // nothing
       | ^
       = the least scene is `Layer()`
    "#);
    assert_snapshot!(errors("Layer(\0)"), @r#"
    error[syntax]: a scene cannot contain a zero byte
      --> scene.ron:1:7
       |
     1 | Layer(�)
       |       ^
    "#);
}

#[test]
fn long_lines_and_tabs_are_cut_around_the_caret() {
    let many = "\"/A\": Def(), ".replace('A', &"a".repeat(60));
    assert_snapshot!(errors(&format!(
        "Layer(prims: {{\t{many}\"/W\": Def(Camera: (fvo: 1)), {many}}})"
    )), @r#"
    error[unknown-field]: `Camera` has no field `fvo`
      --> scene.ron:1:107
       |
     1 | …aaaaaaaaaaaaaaaaaaaaaaaaaa": Def(), "/W": Def(Camera: (fvo: 1)), "/aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa…
       |                                                         ^^^ did you mean `fov`?
       = fields of Camera: fov, fstop (pipeline schema Camera)

    error[duplicate-prim]: `/aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa` is written twice
      --> scene.ron:1:118
       |
     1 | …aaaaaaaaaaaaaaa": Def(), "/W": Def(Camera: (fvo: 1)), "/aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa…
       |                                                         ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
       = first written: scene.ron:1:17
    "#);
    assert_snapshot!(errors("Layer(prims: {\n\t\t\"/Ä\": Def(),\n})"), @r#"
    error[bad-name]: `Ä` is not a name; names are letters, digits and `_`, not beginning with a digit
      --> scene.ron:2:4
       |
     2 |         "/Ä": Def(),
       |          ^^
    "#);
}
