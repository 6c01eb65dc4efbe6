use super::{Diffuse, TextureChannel, TextureEncoding, TextureFilter, TextureMap, TextureWrap, VocabularyPlugin};
use bevy_app::App;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use scene_format::{ComponentInfo, Options, Schema, flatten_ron, load_str, schema_text};
use std::path::{Path, PathBuf};

/// What of the vocabulary exists, as the documentation of the scene format lists it: `-` is required, `?` optional.
const TABLE: &str = "
Band            | inner_radius 0.9 | outer_radius 1 | height 0.5 | bevel 0
Camera          | fov 40
Conductor       | metal ? | eta ? | k ? | f0 ? | reflectance (1, 1, 1) | roughness 0 | distribution Ggx | energy_compensation true | tint (1, 1, 1)
Cuboid          | size (1, 1, 1)
Cylinder        | radius 1 | height 1 | capped true
Dielectric      | ior 1.5 | roughness 0 | energy_compensation true | tint (1, 1, 1) | absorption (0, 0, 0) | dispersion ? | thin false | priority 0
Diffuse         | albedo (0.5, 0.5, 0.5) | albedo_texture ?
Disc            | radius 1
DistantLight    | irradiance (1, 1, 1) | angle 0.53
Emission        | radiance (1, 1, 1) | power ? | two_sided false
EnvironmentLight | file ? | radiance (1, 1, 1) | scale 1
Film            | resolution (512, 512) | filter BlackmanHarris | filter_radius 1.5 | variance true | exposure 0 | tone_map Filmic
LightTransport  | direct SampleLights | specular Trace | caustic PhotonMap | indirect IrradianceCache | specular_alpha 0.05
LookAt          | target - | up (0, 1, 0)
MaterialBinding | target -
Mesh            | file - | mesh ? | primitive ? | smooth true | colors true
Plastic         | albedo (0.5, 0.5, 0.5) | ior 1.5 | roughness 0.1
PointLight      | power (1, 1, 1) | intensity ?
Principled      | base_color (0.5, 0.5, 0.5) | base_color_texture ? | metallic 0 | metallic_texture ? | roughness 0.5 | roughness_texture ? | ior 1.5 | specular 1 | specular_texture ? | specular_color (1, 1, 1) | specular_color_texture ? | transmission 0 | transmission_texture ? | thickness 0 | attenuation_color (1, 1, 1) | attenuation_distance ? | priority 0 | clearcoat 0 | clearcoat_texture ? | clearcoat_roughness 0 | clearcoat_roughness_texture ? | sheen (0, 0, 0) | sheen_texture ? | sheen_roughness 0 | sheen_roughness_texture ? | emission (0, 0, 0) | emission_texture ? | alpha 1 | alpha_texture ? | alpha_cutoff ? | normal_texture ? | normal_scale 1
Quad            | size (1, 1)
Render          | camera - | samples 64 | max_depth ? | seed 0 | passes ?
Sphere          | radius 1
SpotLight       | power (1, 1, 1) | intensity ? | inner_angle 20 | outer_angle 30
Torus           | major_radius 1 | minor_radius 0.25
Transform       | translate (0, 0, 0) | rotate (0, 0, 0) | scale (1, 1, 1) | quaternion ? | matrix ?
";

fn with_schema<T>(use_it: impl FnOnce(&Schema<'_>) -> T) -> T {
    let mut app = App::empty();
    app.init_resource::<AppTypeRegistry>();
    app.add_plugins(VocabularyPlugin);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let schema = Schema::new(&registry, |found| found.contains::<ReflectComponent>()).expect("a sound vocabulary");
    use_it(&schema)
}

/// Says of each field what the table says, from what `pipeline schema` prints.
fn describe(schema: &Schema<'_>, component: &ComponentInfo) -> String {
    let printed = schema_text(schema, Some(component.name)).expect("a registered component");
    let mut described = component.name.to_owned();
    for field in &component.fields {
        let start = format!("  {}: ", field.name);
        let facts = printed
            .lines()
            .find_map(|line| line.strip_prefix(&start))
            .expect("a line for each field");
        let facts = facts.split(", excludes").next().unwrap_or(facts);
        let value = match facts.split_once("default ") {
            Some((_, default)) => default,
            None if field.required => "-",
            None => "?",
        };
        described.push_str(&format!(" | {} {value}", field.name));
    }
    described
}

#[test]
fn components_are_those_of_the_table() {
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let expected: Vec<String> = TABLE.trim().lines().map(words).collect();
    let registered: Vec<String> =
        with_schema(|schema| schema.components().iter().map(|c| describe(schema, c)).collect());
    assert_eq!(registered, expected);
}

#[test]
fn everything_is_documented_and_every_number_has_a_range_or_needs_none() {
    // Any finite number makes sense here.
    const FREE: [&str; 10] = [
        "Transform.translate",
        "Transform.rotate",
        "Transform.scale",
        "Transform.quaternion",
        "Transform.matrix",
        "LookAt.target",
        "LookAt.up",
        "Render.seed",
        "Conductor.metal",
        "Principled.normal_scale",
    ];
    with_schema(|schema| {
        for component in schema.components() {
            assert!(component.docs.is_some(), "{}", component.name);
            let printed = schema_text(schema, Some(component.name)).expect("a registered component");
            for field in &component.fields {
                let name = format!("{}.{}", component.name, field.name);
                assert!(field.docs.is_some(), "{name}");
                let line = printed
                    .lines()
                    .find(|line| line.starts_with(&format!("  {}: ", field.name)));
                let is_number = line.is_some_and(|line| line.contains("number"));
                assert!(
                    !is_number || field.range.is_some() || FREE.contains(&name.as_str()),
                    "{name}"
                );
            }
        }
    });
}

fn refusal(component: &str) -> String {
    let text = format!(r#"Layer(prims: {{"/Scene": Def({component})}})"#);
    with_schema(
        |schema| match load_str("scene.ron", &text, schema, &Options::default()) {
            Ok(_) => "no error".to_owned(),
            Err(errors) => errors.to_string(),
        },
    )
}

#[test]
fn a_method_that_does_not_exist_names_those_that_do() {
    let indirect = refusal("LightTransport: (indirect: RayTrace)");
    assert!(
        indirect.contains(
            "`LightTransport.indirect` must be one of PathTrace, PhotonMap, FinalGather, Radiosity, IrradianceCache, Off"
        ),
        "{indirect}"
    );
    assert!(indirect.contains("scene.ron:1:"), "{indirect}");
    let direct = refusal("LightTransport: (direct: PathTrace)");
    assert!(
        direct.contains("must be one of SampleLights, PhotonMap, Off"),
        "{direct}"
    );
}

#[test]
fn numbers_out_of_range_are_refused() {
    for bad in [
        "Sphere: (radius: 0)",
        "Quad: (size: (1, -1))",
        "Diffuse: (albedo: (0.5, 0.5, 1.5))",
        "Dielectric: (ior: 0)",
        "Plastic: (ior: 0.9)",
        "Principled: (metallic: 1.1)",
        "Principled: (attenuation_distance: 0)",
        "Dielectric: (absorption: (-1, 0, 0))",
        "Emission: (radiance: (-1, 0, 0))",
        "Camera: (fov: 180)",
        "PointLight: (intensity: (0, 0, -1))",
        "EnvironmentLight: (scale: -1)",
        "Film: (resolution: (0, 8))",
        "Film: (resolution: (8, 100000))",
        "Render: (camera: \"/Scene\", samples: 0)",
        "Render: (camera: \"/Scene\", samples: 4000000000)",
        "LightTransport: (specular_alpha: 2)",
        "SpotLight: (outer_angle: 0.0099)",
        "Dielectric: (dispersion: 1)",
        "Dielectric: (dispersion: 1e5)",
    ] {
        assert!(refusal(bad).contains("error[out-of-range]"), "{bad}: {}", refusal(bad));
    }
    // The bounds themselves, also where single precision has no such number.
    for good in ["SpotLight: (outer_angle: 0.01)", "Dielectric: (dispersion: 5)"] {
        assert_eq!(refusal(good), "no error", "{good}");
    }
}

#[test]
fn either_or_fields_exclude_each_other() {
    for bad in [
        "Conductor: (metal: \"gold\", f0: (1, 1, 1))",
        "Conductor: (eta: (1, 1, 1), k: (1, 1, 1), metal: \"gold\")",
        "Emission: (radiance: (1, 1, 1), power: (1, 1, 1))",
        "PointLight: (power: (1, 1, 1), intensity: (1, 1, 1))",
        "Transform: (rotate: (0, 90, 0), quaternion: (0, 0, 0, 1))",
    ] {
        assert!(
            refusal(bad).contains("error[exclusive-fields]"),
            "{bad}: {}",
            refusal(bad)
        );
    }
    assert!(refusal("Conductor: (eta: (1, 1, 1))").contains("`eta` needs `k` too"));
    assert_eq!(refusal("Conductor: (eta: (1, 1, 1), k: (1, 1, 1))"), "no error");
}

/// Composes a scene of one material without looking for files.
fn composed<T>(component: &str, use_it: impl FnOnce(&Schema<'_>, &scene_format::Scene) -> T) -> T {
    let text = format!(r#"Layer(prims: {{"/Scene": Def({component})}})"#);
    let options = Options {
        check_assets: false,
        ..Options::default()
    };
    with_schema(|schema| {
        let scene = load_str("scene.ron", &text, schema, &options).unwrap_or_else(|errors| panic!("{errors}"));
        use_it(schema, &scene)
    })
}

fn albedo_texture(value: &str) -> TextureMap {
    composed(&format!("Diffuse: (albedo_texture: {value})"), |schema, scene| {
        let built = scene.prims[0].components[0].build(schema, 0.0).take::<Diffuse>();
        built.expect("a `Diffuse`").albedo_texture.expect("a texture")
    })
}

#[test]
fn a_texture_is_a_file_or_a_file_with_more() {
    let short = albedo_texture(r#""wood.png""#);
    assert_eq!(short.file.0, "wood.png");
    assert_eq!(short, albedo_texture(r#"(file: "wood.png")"#));
    assert_eq!(short.scale, glam::Vec2::ONE);
    assert_eq!(short.factor, glam::Vec3::ONE);
    let long = albedo_texture(
        r#"(file: "a.glb", image: 2, uv_set: 1, wrap_u: Mirror, wrap_v: Clamp, filter: Nearest, translate: (0.5, 1),
            rotate: -90, scale: (4, 2), encoding: Srgb, channel: A, factor: (0.5, 1, 2))"#,
    );
    assert_eq!((long.image, long.uv_set, long.rotate), (Some(2), 1, -90.0));
    assert_eq!((long.wrap_u, long.wrap_v), (TextureWrap::Mirror, TextureWrap::Clamp));
    assert_eq!(
        (long.filter, long.encoding),
        (TextureFilter::Nearest, TextureEncoding::Srgb)
    );
    assert_eq!((long.channel, long.factor.z), (TextureChannel::A, 2.0));
    assert_eq!((long.translate.y, long.scale.x), (1.0, 4.0));
}

#[test]
fn what_is_wrong_inside_of_a_texture_is_named() {
    for (bad, note) in [
        (
            r#"(file: "a.png", wrap: Clamp)"#,
            "Unexpected field named `wrap`, expected one of `file`",
        ),
        (r#"(scale: (2, 2))"#, "missing field named `file`"),
        (r#"(file: "a.png", file: "b.png")"#, "duplicate field named `file`"),
        (r#"(file: "a.png", factor: (1, -2, 1))"#, "a `factor` of at least 0"),
        (
            r#"(file: "a.png", wrap_u: Round)"#,
            "one of `Repeat`, `Mirror`, or `Clamp`",
        ),
        ("7", "must be a file, or (file: .., "),
    ] {
        let message = refusal(&format!("Diffuse: (albedo_texture: {bad})"));
        assert!(
            message.contains("error[wrong-type]") && message.contains(note),
            "{bad}: {message}"
        );
        assert!(message.contains("scene.ron:1:"), "{bad}: {message}");
    }
    let endless = refusal(r#"Diffuse: (albedo_texture: (file: "a.png", rotate: inf))"#);
    assert!(endless.contains("error[not-finite]"), "{endless}");
}

#[test]
fn textures_count_in_the_hash_and_survive_flattening() {
    let hash = |value: &str| composed(&format!("Diffuse: (albedo_texture: {value})"), |_, scene| scene.hash);
    assert_eq!(hash(r#""a.png""#), hash(r#"(file: "a.png", uv_set: 0)"#));
    for other in [
        r#""b.png""#,
        r#"(file: "a.png", wrap_v: Clamp)"#,
        r#"(file: "a.png", factor: (1, 1, 2))"#,
    ] {
        assert_ne!(hash(r#""a.png""#), hash(other), "{other}");
    }
    let component = r#"Principled: (normal_texture: (file: "n.png", scale: (0.5, 2), channel: G, image: 3))"#;
    composed(component, |schema, scene| {
        let flat = scene_format::flatten_ron(scene);
        let again = load_str(
            "flat.ron",
            &flat,
            schema,
            &Options {
                check_assets: false,
                ..Options::default()
            },
        )
        .unwrap_or_else(|errors| panic!("{flat}\n{errors}"));
        assert_eq!(again.hash, scene.hash, "{flat}");
        let json = scene_format::flatten_json(scene);
        assert!(
            json.contains(r#""channel":"G""#) && json.contains(r#""file":"n.png""#),
            "{json}"
        );
        let explained = scene_format::explain(scene, "/Scene.normal_texture").expect("an opinion");
        assert!(explained.contains("n.png") && explained.contains("wins"), "{explained}");
    });
}

fn models() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/assets/gltf");
    folder.canonicalize().expect("the folder of models is there")
}

/// What a model file composes to, written as one layer and composed again, is the same.
#[test]
fn flattened_models_read_back() {
    let folder = models();
    let mut read = 0;
    for name in names_in(&folder) {
        for file in names_in(&folder.join(&name)) {
            if !file.ends_with(".gltf") && !file.ends_with(".glb") {
                continue;
            }
            let scene = format!(r#"Layer(prims: {{"/Model": Def(references: ["{name}/{file}"])}})"#);
            let as_file = folder.join("scene.ron");
            let compose = |text: &str| {
                let loaded =
                    with_schema(|schema| load_str(&as_file.to_string_lossy(), text, schema, &Options::default()));
                loaded.unwrap_or_else(|errors| panic!("{file}: {errors}"))
            };
            let first = compose(&scene);
            let again = compose(&flatten_ron(&first));
            assert!(first.prims.len() > 1 && again.hash == first.hash, "{file}");
            let paths =
                |scene: &scene_format::Scene| scene.prims.iter().map(|prim| prim.path.clone()).collect::<Vec<_>>();
            assert_eq!(paths(&again), paths(&first), "{file}");
            read += 1;
        }
    }
    assert!(read > 20, "{read}");
}

fn names_in(folder: &Path) -> Vec<String> {
    let Ok(entries) = folder.read_dir() else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    names.sort();
    names
}

#[test]
fn normals_of_a_model_may_lean_the_other_way() {
    let model = r#"{"asset": {"version": "2.0"}, "images": [{"uri": "a.png"}], "textures": [{"source": 0}],
        "materials": [{"normalTexture": {"index": 0, "scale": -2}}], "nodes": [{}], "scenes": [{"nodes": [0]}]}"#;
    let folder = tempfile::tempdir().expect("a folder to write to");
    std::fs::write(folder.path().join("a.gltf"), model).expect("a file to write");
    let options = Options {
        check_assets: false,
        ..Options::default()
    };
    let name = folder.path().join("scene.ron");
    let text = r#"Layer(prims: {"/A": Def(references: ["a.gltf"])})"#;
    let loaded = with_schema(|schema| load_str(&name.to_string_lossy(), text, schema, &options));
    let scene = loaded.unwrap_or_else(|errors| panic!("{errors}"));
    assert!(
        flatten_ron(&scene).contains("normal_scale: -2"),
        "{}",
        flatten_ron(&scene)
    );
}
