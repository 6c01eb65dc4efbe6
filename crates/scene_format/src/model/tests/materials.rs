//! Materials of glTF files become `Principled`.

use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use super::document::changed;
use super::vocabulary::{Channel, Filter, Principled, TextureMap, Wrap, component, compose};
use super::*;

/// Two textures of two images; the second has a sampler.
fn pictures() -> [(&'static str, Value); 3] {
    [
        (
            "/images",
            json!([{"uri": "a.png"}, {"bufferView": 0, "mimeType": "image/png"}]),
        ),
        (
            "/samplers",
            json!([{"magFilter": 9728, "minFilter": 9987, "wrapS": 33071, "wrapT": 33648}]),
        ),
        ("/textures", json!([{"source": 0}, {"source": 1, "sampler": 0}, {}])),
    ]
}

/// Translates the square with the textures and a material; gives the material and the warnings.
fn material(changes: &Value) -> (Principled, Vec<String>) {
    let mut all = pictures().to_vec();
    all.push(("/materials/0", changes.clone()));
    let translated = translate("square.gltf", &changed(&all)).unwrap();
    let scene = compose(&translated.text);
    (
        component(&scene, "/square/Materials/Material0", "Principled"),
        warnings(&translated),
    )
}

fn factor(map: &Option<TextureMap>) -> Vec3 {
    map.as_ref().unwrap().factor.unwrap_or(Vec3::ONE)
}

#[test]
fn metal_and_plastic() {
    let (found, warnings) = material(&json!({"pbrMetallicRoughness": {
        "baseColorFactor": [0.5, 2.0, -1.0, 0.25], "metallicFactor": 0.25, "roughnessFactor": 7,
    }}));
    assert_eq!(found.base_color, Vec3::new(0.5, 1.0, 0.0));
    assert_eq!((found.metallic, found.roughness), (0.25, 1.0));
    assert!(found.base_color_texture.is_none() && warnings.is_empty());
    assert_eq!(
        (found.alpha, found.alpha_cutoff),
        (0.0, None),
        "not written: the file says opaque"
    );
}

#[test]
fn textures_replace_fields() {
    let (found, warnings) = material(&json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 1.0, 1.0, 1.0], "baseColorTexture": {"index": 0, "texCoord": 2},
            "metallicFactor": 0, "metallicRoughnessTexture": {"index": 1},
        },
        "normalTexture": {"index": 1, "scale": 0.5},
        "occlusionTexture": {"index": 0},
        "emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform": {
            "offset": [0.25, 0.5], "rotation": std::f64::consts::FRAC_PI_2, "scale": [2, 3], "texCoord": 1,
        }}},
        "emissiveFactor": [1, 0.5, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
    }));
    assert_eq!(warnings, [""; 0]);
    let base = found.base_color_texture.unwrap();
    assert_eq!((&base.file.0[..], base.image, base.uv_set), ("square.gltf", Some(0), 2));
    assert_eq!(
        (base.wrap_u, base.filter, base.channel),
        (Wrap::Repeat, Filter::Linear, Channel::R)
    );
    assert_eq!(base.factor, Some(Vec3::new(0.5, 1.0, 1.0)));
    assert!(found.metallic_texture.is_none(), "0 times a texture is 0");
    let rough = found.roughness_texture.unwrap();
    assert_eq!((rough.image, rough.channel, rough.factor), (Some(1), Channel::G, None));
    assert_eq!(
        (rough.wrap_u, rough.wrap_v, rough.filter),
        (Wrap::Clamp, Wrap::Mirror, Filter::Nearest)
    );
    assert!(found.normal_texture.is_some() && found.normal_scale == 0.5);
    let glow = found.emission_texture.unwrap();
    assert_eq!(glow.factor, Some(Vec3::new(8.0, 4.0, 0.0)));
    assert_eq!(
        (glow.translate, glow.rotate, glow.uv_set),
        (Vec2::new(0.25, 0.5), 90.0, 1)
    );
    assert_eq!(glow.scale, Some(Vec2::new(2.0, 3.0)));
}

#[test]
fn extensions_become_fields() {
    let (found, warnings) = material(&json!({"extensions": {
        "KHR_materials_ior": {"ior": 1.25},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularTexture": {"index": 0},
            "specularColorFactor": [2, 1, 1]},
        "KHR_materials_transmission": {"transmissionFactor": 0.75, "transmissionTexture": {"index": 0}},
        "KHR_materials_volume": {"thicknessFactor": 2, "thicknessTexture": {"index": 0},
            "attenuationDistance": 1e-300, "attenuationColor": [1, 0.5, 0]},
        "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.5,
            "clearcoatRoughnessTexture": {"index": 0}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0, 0], "sheenColorTexture": {"index": 0},
            "sheenRoughnessFactor": 0.25, "sheenRoughnessTexture": {"index": 0}},
    }}));
    assert_eq!(warnings, [""; 0]);
    assert_eq!(found.ior, 1.25);
    assert_eq!(factor(&found.specular_texture), Vec3::splat(0.5));
    assert_eq!(found.specular_texture.unwrap().channel, Channel::A);
    assert_eq!(found.specular_color, Vec3::new(2.0, 1.0, 1.0));
    assert_eq!(factor(&found.transmission_texture), Vec3::splat(0.75));
    assert_eq!((found.thickness, found.attenuation_distance), (2.0, Some(1e-30)));
    assert_eq!(found.attenuation_color, Vec3::new(1.0, 0.5, 0.0));
    assert_eq!(found.clearcoat, 1.0);
    assert_eq!(found.clearcoat_roughness_texture.unwrap().channel, Channel::G);
    assert_eq!(factor(&found.sheen_texture), Vec3::new(0.5, 0.0, 0.0));
    assert_eq!(found.sheen_roughness_texture.unwrap().channel, Channel::A);
}

#[test]
fn coverage_is_of_the_base_colour() {
    let with = |mode: &str| {
        material(
            &json!({"alphaMode": mode, "alphaCutoff": 0.75, "pbrMetallicRoughness": {
                "baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": {"index": 1},
            }}),
        )
        .0
    };
    let opaque = with("OPAQUE");
    assert!(opaque.alpha_texture.is_none() && opaque.alpha_cutoff.is_none());
    let mask = with("MASK");
    assert_eq!(mask.alpha_texture.as_ref().unwrap().channel, Channel::A);
    assert_eq!(
        (factor(&mask.alpha_texture), mask.alpha_cutoff),
        (Vec3::splat(0.5), Some(0.75))
    );
    let blend = with("BLEND");
    assert_eq!(
        (factor(&blend.alpha_texture), blend.alpha_cutoff),
        (Vec3::splat(0.5), None)
    );
    let (plain, _) = material(&json!({"alphaMode": "BLEND", "pbrMetallicRoughness": {
        "baseColorFactor": [1, 1, 1, 0.5],
    }}));
    assert_eq!((plain.alpha, plain.alpha_texture), (0.5, None));
}

#[test]
fn what_is_unlit_shines() {
    let (found, _) = material(&json!({
        "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1], "baseColorTexture": {"index": 0}},
        "normalTexture": {"index": 0},
        "extensions": {"KHR_materials_unlit": {}},
    }));
    assert_eq!((found.base_color, found.specular), (Vec3::ZERO, 0.0));
    assert_eq!(factor(&found.emission_texture), Vec3::new(1.0, 0.5, 0.0));
    assert!(found.base_color_texture.is_none() && found.normal_texture.is_none());
}

#[test]
fn what_is_odd_or_left_out_is_a_warning() {
    let (found, said) = material(&json!({
        "doubleSided": true,
        "emissiveFactor": [1, 1, 1],
        "normalTexture": {"index": 2},
        "extensions": {
            "KHR_materials_ior": {"ior": 0},
            "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatNormalTexture": {"index": 0}},
            "KHR_materials_iridescence": {},
            "KHR_materials_anisotropy": {},
            "KHR_materials_dispersion": {},
            "KHR_materials_pbrSpecularGlossiness": {},
        },
    }));
    assert_eq!(found.ior, 4.0);
    insta::assert_snapshot!(said.join("\n"), @r#"
    materials[0].extensions.KHR_materials_ior.ior: an index of refraction of 0 is out of range, 4 is used
    not supported yet, so left out: anisotropy, dispersion, iridescence, light from the backs of double-sided materials, normal textures of clear coats, specular-glossiness materials, textures that are neither PNG nor JPEG
    "#);
    let odd = changed(&[("/samplers", json!([{"magFilter": 1, "wrapT": 10497, "wrapS": 2}]))]);
    insta::assert_snapshot!(warnings(&translate("a.gltf", &odd).unwrap()).join("\n"), @r#"
    samplers[0].magFilter: 1 is none of [9728, 9729], so the default is used
    samplers[0].wrapS: 2 is none of [33071, 33648, 10497], so the default is used
    "#);
}

#[test]
fn a_vocabulary_without_materials_gets_none() {
    let registry = super::vocabulary::registry();
    let schema = crate::Schema::new(&registry, |found| found.type_info().type_path().ends_with("::Mesh")).unwrap();
    let root = data_folder();
    let path = root.join("a.gltf");
    let bytes = changed(&[]);
    let translated = translate_model(&file(&path, &root, &bytes), &schema, &ModelLimits::default()).unwrap();
    assert!(!translated.text.contains("Material"), "{}", translated.text);
    assert_eq!(warnings(&translated), ["not supported yet, so left out: materials"]);
}

#[test]
fn materials_that_point_nowhere() {
    let said = |pointer: &str, value: Value| {
        let mut all = pictures().to_vec();
        all.push((pointer, value));
        translate("a.gltf", &changed(&all)).unwrap_err().to_string()
    };
    let coat = json!({"KHR_materials_clearcoat": {"clearcoatNormalTexture": {"index": 3}}});
    let all = [
        said("/materials/0/emissiveTexture", json!({"index": 3})),
        said("/materials/0/extensions", coat),
        said("/textures/0/source", json!(2)),
        said("/textures/0/sampler", json!(1)),
        said("/materials/0/alphaMode", json!("HALF")),
    ];
    insta::assert_snapshot!(all.join("\n"), @r#"
    a.gltf: materials[0].emissiveTexture.index: there is no texture 3, the file has 3; export the model again, or check it with a validator
    a.gltf: materials[0].extensions.KHR_materials_clearcoat.clearcoatNormalTexture.index: there is no texture 3, the file has 3; export the model again, or check it with a validator
    a.gltf: textures[0].source: there is no image 2, the file has 2; export the model again, or check it with a validator
    a.gltf: textures[0].sampler: there is no sampler 1, the file has 1; export the model again, or check it with a validator
    a.gltf: materials[0].alphaMode: unknown variant `HALF`, expected one of `OPAQUE`, `MASK`, `BLEND` at line 1 column 836; export the model again, or check it with a validator
    "#);
}
