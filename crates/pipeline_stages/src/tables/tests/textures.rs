//! Textures, vertex colours, alpha and normal maps, from the scene to the surface.

use super::{CAMERA, RENDER, SKY, errors, prepare_files, warnings};
use bevy_app::App;
use film::{Image, Metadata, RgbImage};
use glam::Vec3;
use pipeline_core::{Counters, Report};
use pipeline_data::{ComposedScene, RenderRequest, SceneOrigin, TransportScene};
use radiometry::Rgb;
use scattering::Bsdf;
use spatial::{Ray, SurfacePoint};
use std::path::Path;
use transport::Scene;

/// Red, green above blue, white: linear values, from the top.
const FOUR: [[f32; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];
/// Where a quad of 2 m shows the texels of [`FOUR`].
const PLACES: [(f32, f32); 4] = [(-0.5, 0.5), (0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)];

fn write_exr(path: &Path, width: u32, pixels: &[[f32; 3]]) {
    let image = Image::from_rgb(&RgbImage {
        width,
        height: pixels.len() as u32 / width,
        pixels: pixels.to_vec(),
    });
    film::write_exr(path, &image, &Metadata::default()).unwrap();
}

fn write_files(folder: &Path) {
    write_exr(&folder.join("four.exr"), 2, &FOUR);
    write_exr(&folder.join("flat.exr"), 1, &[[0.5, 0.5, 1.0]]);
    write_exr(&folder.join("tilted.exr"), 1, &[[0.8, 0.5, 0.9]]);
    write_exr(&folder.join("half.exr"), 2, &[[0.25, 0.0, 0.0], [0.75, 1.0, 0.0]]);
    film::write_rgb8_png(&folder.join("grey.png"), 1, 1, &[128; 3]).unwrap();
    let (gltf, buffer) = coloured_quad();
    std::fs::write(folder.join("quad.gltf"), gltf).unwrap();
    std::fs::write(folder.join("quad.bin"), buffer).unwrap();
}

/// A quad from −1 to 1 with colours that grow from (0, 0, 1, 0.5) in the lower left, and an image.
fn coloured_quad() -> (String, Vec<u8>) {
    let corners = [[-1.0_f32, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]);
    let colours = corners
        .iter()
        .flat_map(|[x, y]| [0.5 + 0.5 * x, 0.5 + 0.5 * y, 1.0, 0.5]);
    let mut buffer: Vec<u8> = positions.chain(colours).flat_map(f32::to_le_bytes).collect();
    buffer.extend([0_u16, 1, 2, 0, 2, 3].into_iter().flat_map(u16::to_le_bytes));
    let text = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "quad.bin", "byteLength": 124}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 64},
            {"buffer": 0, "byteOffset": 112, "byteLength": 12}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC4"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "images": [{"uri": "grey.png"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2}]}]}"#;
    (text.to_owned(), buffer)
}

fn prepare(prims: &str) -> App {
    prepare_files(&[prims, SKY, CAMERA, RENDER], write_files, |_| ())
}

/// A quad from −1 to 1 of a material.
fn quad(material: &str) -> App {
    let app = prepare(&format!("\"/A\": Def(Quad: (size: (2, 2)), {material}),\n"));
    assert_eq!(errors(&app), "", "{material}");
    app
}

fn scene(app: &App) -> &Scene {
    assert_eq!(errors(app), "");
    &app.world().resource::<TransportScene>().0
}

/// What a ray from +Z meets.
fn point(app: &App, (x, y): (f32, f32)) -> SurfacePoint {
    let origin = app.world().resource::<SceneOrigin>().0.as_vec3();
    let ray = Ray::new(Vec3::new(x, y, 100.0) - origin, -Vec3::Z);
    let rays = &scene(app).rays;
    rays.surface(&ray, &rays.intersect(&ray).unwrap())
}

fn surface(app: &App, place: (f32, f32)) -> (Bsdf, Vec3) {
    let point = point(app, place);
    scene(app).material(&point).at(&scene(app).rays, &point)
}

fn albedo(app: &App, place: (f32, f32)) -> Rgb {
    surface(app, place).0.albedo(Vec3::Z)
}

fn assert_near(found: Rgb, expected: [f32; 3]) {
    let difference = Vec3::from(found) - Vec3::from(expected);
    assert!(difference.length() < 1e-5, "{found:?} {expected:?}");
}

#[test]
fn a_texture_replaces_the_plain_field() {
    let app = quad("Diffuse: (albedo_texture: \"four.exr\")");
    for (place, expected) in PLACES.into_iter().zip(FOUR) {
        assert_near(albedo(&app, place), expected);
    }
    assert_near(albedo(&app, (0.0, 0.5)), [0.5, 0.5, 0.0]);
    assert_eq!(warnings(&app), "");
    assert_eq!(app.world().resource::<Counters>().get("load/textures"), 1);
    let both = quad("Diffuse: (albedo: (0.1, 0.1, 0.1), albedo_texture: \"four.exr\")");
    assert_near(albedo(&both, PLACES[1]), FOUR[1]);
    assert!(
        warnings(&both).contains("warning[without-effect]: `Diffuse.albedo` has no effect beside `albedo_texture`"),
        "{}",
        warnings(&both)
    );
}

#[test]
fn a_factor_multiplies_and_shares_stay_below_one() {
    let app = quad("Diffuse: (albedo_texture: (file: \"four.exr\", factor: (0.5, 0.25, 4)))");
    assert_near(albedo(&app, PLACES[3]), [0.5, 0.25, 1.0]);
    let metal = quad(
        "Principled: (base_color_texture: (file: \"four.exr\", factor: (0.5, 1, 1)), metallic: 1, roughness: 0, specular_texture: \
         (file: \"half.exr\", channel: G))",
    );
    assert_near(albedo(&metal, PLACES[3]), [0.5, 1.0, 1.0]);
}

#[test]
fn wrap_filter_and_transform_reach_the_surface() {
    let twice = quad("Diffuse: (albedo_texture: (file: \"four.exr\", scale: (2, 2), filter: Nearest, wrap_u: Clamp))");
    assert_near(albedo(&twice, (-0.75, 0.75)), FOUR[0]);
    assert_near(albedo(&twice, (0.3, 0.75)), FOUR[1]);
    assert_near(albedo(&twice, (0.9, -0.25)), FOUR[1]);
    let turned = quad("Diffuse: (albedo_texture: (file: \"four.exr\", rotate: 90, translate: (0, 1)))");
    // Turned clockwise, the upper left corner shows the lower left of the picture.
    assert_near(albedo(&turned, PLACES[0]), FOUR[2]);
    assert_near(albedo(&turned, PLACES[1]), FOUR[0]);
}

#[test]
fn colours_are_srgb_and_data_is_linear() {
    let grey = 128.0_f32 / 255.0;
    let decoded = radiometry::math::powf((grey + 0.055) / 1.055, 2.4);
    assert_near(
        albedo(&quad("Diffuse: (albedo_texture: \"grey.png\")"), (0.3, 0.3)),
        [decoded; 3],
    );
    let linear = quad("Diffuse: (albedo_texture: (file: \"grey.png\", encoding: Linear))");
    assert_near(albedo(&linear, (0.3, 0.3)), [grey; 3]);
    let alpha = quad("Principled: (alpha_texture: \"grey.png\")");
    assert_eq!(scene(&alpha).alpha(&point(&alpha, (0.1, 0.1))), grey);
    let image = quad("Diffuse: (albedo_texture: (file: \"quad.gltf\", image: 0, encoding: Linear))");
    assert_near(albedo(&image, (0.3, 0.3)), [grey; 3]);
}

#[test]
fn what_a_surface_has_anywhere_counts_for_all_of_it() {
    let has = |material: &str| {
        let app = quad(material);
        let material = scene(&app).material(&point(&app, (0.2, 0.2)));
        [
            material.has_diffuse(),
            material.has_specular(),
            material.transmits(),
            material.has_alpha(),
        ]
    };
    // Green goes from 0 to 1, red from 0.25 to 0.75.
    let green = "(file: \"half.exr\", channel: G)";
    assert_eq!(has("Principled: (roughness: 0.5)"), [true, false, false, false]);
    assert_eq!(
        has(&format!("Principled: (roughness_texture: {green})")),
        [true, true, false, false]
    );
    assert_eq!(
        has("Principled: (roughness_texture: \"half.exr\")"),
        [true, false, false, false]
    );
    let dielectric = "Principled: (roughness: 0, metallic: 1, specular: 0";
    assert_eq!(has(&format!("{dielectric})")), [false, true, false, false]);
    assert_eq!(
        has("Principled: (roughness: 0, metallic_texture: \"half.exr\")"),
        [true, true, false, false]
    );
    assert_eq!(
        has(&format!("Principled: (transmission_texture: {green})"))[2..],
        [true, false]
    );
    assert_eq!(has("Principled: (alpha_texture: \"half.exr\")")[3..], [true]);
    assert_eq!(
        has("Principled: (alpha_texture: \"half.exr\", alpha_cutoff: 0.2)")[3..],
        [false]
    );
    assert_eq!(has("Principled: (alpha: 1)")[3..], [false]);
    assert_eq!(has("Principled: (alpha: 0.5)")[3..], [true]);
}

#[test]
fn a_cutoff_leaves_all_or_nothing() {
    let app = quad("Principled: (alpha_texture: (file: \"half.exr\", filter: Nearest), alpha_cutoff: 0.5)");
    assert!(scene(&app).has_alpha());
    let alpha = |x| scene(&app).alpha(&point(&app, (x, 0.0)));
    assert_eq!([alpha(-0.5), alpha(0.5)], [0.0, 1.0]);
    let half = quad("Principled: (alpha_texture: (file: \"half.exr\", factor: (0.5, 1, 1)))");
    assert_eq!(scene(&half).alpha(&point(&half, (-0.5, 0.0))), 0.125);
}

#[test]
fn a_flat_normal_map_changes_no_bit_and_a_tilted_one_tilts() {
    let normal = |map: &str, place| surface(&quad(&format!("Principled: (normal_texture: {map})")), place).1;
    assert_eq!(normal("\"flat.exr\"", (0.3, 0.2)), Vec3::Z);
    let leaning = Vec3::new(0.6, 0.0, 0.8);
    assert!((normal("\"tilted.exr\"", (0.3, 0.2)) - leaning).length() < 1e-6);
    // A picture turned by 90° clockwise: what leaned to the right leans down.
    let turned = normal("(file: \"tilted.exr\", rotate: 90)", (0.3, 0.2));
    assert!((turned - Vec3::new(0.0, -0.6, 0.8)).length() < 1e-6, "{turned}");
    let mirrored = normal("(file: \"tilted.exr\", scale: (-1, 1))", (0.3, 0.2));
    assert!((mirrored - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6, "{mirrored}");
    let flattened = quad("Principled: (normal_texture: \"tilted.exr\", normal_scale: 0)");
    assert_eq!(surface(&flattened, (0.3, 0.2)).1, Vec3::Z);
    let other_way = quad("Principled: (normal_texture: \"tilted.exr\", normal_scale: -1)");
    assert!((surface(&other_way, (0.3, 0.2)).1 - Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
}

#[test]
fn colours_of_vertices_multiply() {
    let mesh =
        |rest: &str, material: &str| prepare(&format!("\"/A\": Def(Mesh: (file: \"quad.gltf\"{rest}){material}),\n"));
    let plain = mesh("", "");
    assert_near(albedo(&plain, (0.5, -0.5)), [0.375, 0.125, 0.5]);
    let diffuse = ", Diffuse: (albedo: (0.8, 0.8, 0.8))";
    assert_near(albedo(&mesh("", diffuse), (0.5, -0.5)), [0.6, 0.2, 0.8]);
    assert_near(albedo(&mesh(", colors: false", diffuse), (0.5, -0.5)), [0.8; 3]);
    let textured = ", Diffuse: (albedo_texture: (file: \"grey.png\", encoding: Linear, factor: (0.5, 0.5, 0.5)))";
    let coloured = mesh("", textured);
    assert_near(
        albedo(&coloured, (0.5, -0.5)),
        [0.75 * 64.0 / 255.0, 0.25 * 64.0 / 255.0, 64.0 / 255.0],
    );
    assert!(warnings(&coloured).contains("warning[no-coordinates]: `/A` has no texture coordinates"));
    // Alpha of vertices counts where the material has one, too.
    let alpha = |material: &str| {
        let app = mesh("", material);
        scene(&app).alpha(&point(&app, (0.5, -0.5)))
    };
    assert_eq!(alpha(", Principled: ()"), 1.0);
    assert_eq!(alpha(", Principled: (alpha: 0.5)"), 0.25);
}

/// glTF: an opaque material ignores alpha, that of vertices as well.
#[test]
fn a_model_is_as_opaque_as_it_says() {
    let alpha = |mode: &str| {
        let (text, buffer) = coloured_quad();
        let with_material = text
            .replace("\"indices\": 2", "\"indices\": 2, \"material\": 0")
            .replace(
                "\"meshes\"",
                &format!("\"nodes\": [{{\"mesh\": 0}}], \"materials\": [{{{mode}}}], \"meshes\""),
            );
        let write = |folder: &Path| {
            std::fs::write(folder.join("model.gltf"), with_material).unwrap();
            std::fs::write(folder.join("quad.bin"), buffer).unwrap();
        };
        let model = "\"/A\": Def(references: [\"model.gltf\"]),\n";
        let app = prepare_files(&[model, SKY, CAMERA, RENDER], write, |_| ());
        let alpha = scene(&app).alpha(&point(&app, (0.5, -0.5)));
        (alpha, scene(&app).has_alpha())
    };
    assert_eq!(alpha(""), (1.0, false));
    assert_eq!(
        alpha(r#""alphaMode": "OPAQUE", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}"#),
        (1.0, false)
    );
    assert_eq!(alpha(r#""alphaMode": "BLEND""#), (0.5, true));
    assert_eq!(alpha(r#""alphaMode": "MASK""#), (1.0, true));
    assert_eq!(alpha(r#""alphaMode": "MASK", "alphaCutoff": 0.75"#), (0.0, true));
}

#[test]
fn a_material_serves_meshes_with_and_without_colours() {
    let app = prepare(
        "\"/M\": Def(Diffuse: (albedo: (0.8, 0.8, 0.8))),\n\
         \"/A\": Def(Mesh: (file: \"quad.gltf\"), MaterialBinding: (target: \"/M\")),\n\
         \"/B\": Def(Mesh: (file: \"quad.gltf\", colors: false), MaterialBinding: (target: \"/M\"), Transform: (translate: (3, 0, 0))),\n\
         \"/C\": Def(Quad: (size: (2, 2)), MaterialBinding: (target: \"/M\"), Transform: (translate: (6, 0, 0))),\n",
    );
    assert_near(albedo(&app, (0.5, -0.5)), [0.6, 0.2, 0.8]);
    assert_near(albedo(&app, (3.5, -0.5)), [0.8; 3]);
    assert_near(albedo(&app, (6.5, -0.5)), [0.8; 3]);
}

#[test]
fn sets_of_coordinates_that_are_not_there_are_a_warning() {
    let app = quad("Diffuse: (albedo_texture: (file: \"four.exr\", uv_set: 1))");
    let found = warnings(&app);
    assert!(
        found.contains("warning[no-coordinates]: `/A` has no set 1 of texture coordinates")
            && found.contains("scene.ron:2:"),
        "{found}"
    );
    assert_near(albedo(&app, PLACES[0]), FOUR[0]);
}

#[test]
fn pictures_that_cannot_be_are_refused_with_place_and_remedy() {
    for (texture, expected) in [
        (
            "\"quad.bin\"",
            "quad.bin: it is no PNG, JPEG, Radiance HDR or OpenEXR file; convert it",
        ),
        ("\"fur.exr\"", "error[missing-file]: there is no file `fur.exr`"),
        (
            "\"quad.gltf\"",
            "error[missing-field]: a model file holds any number of pictures",
        ),
        ("(file: \"quad.gltf\", image: 7)", "error[bad-texture]: "),
        (
            "(file: \"four.exr\", image: 0)",
            "error[exclusive-fields]: `image` is for `.gltf` and `.glb`",
        ),
        ("(file: \"quad.obj\", image: 0)", "an OBJ file holds no images"),
    ] {
        let app = prepare(&format!(
            "\"/A\": Def(Quad: (), Diffuse: (albedo_texture: {texture})),\n"
        ));
        let found = errors(&app);
        assert!(
            found.contains(expected) && found.contains("scene.ron:2:"),
            "{texture}: {found}"
        );
        assert!(!app.world().contains_resource::<TransportScene>());
    }
}

#[test]
fn a_picture_over_the_limit_is_refused() {
    let limited = |request: &mut RenderRequest| request.options.limits.texture_pixels = 3;
    let prims = "\"/A\": Def(Quad: (), Diffuse: (albedo_texture: \"four.exr\")),\n";
    let app = prepare_files(&[prims, SKY, CAMERA, RENDER], write_files, limited);
    let found = app.world().resource::<Report>().errors().join("\n");
    assert!(
        found.contains("2x2 pixels are more than 3 in all") && found.contains("`texture_pixels`"),
        "{found}"
    );
}

#[test]
fn each_picture_is_decoded_once_and_part_of_the_hash() {
    let hash = |pixels: [[f32; 3]; 2]| {
        let prims = "\"/A\": Def(Quad: (), Diffuse: (albedo_texture: \"own.exr\")),\n\
             \"/B\": Def(Sphere: (), Principled: (base_color_texture: \"own.exr\", sheen_texture: (file: \"./own.exr\", channel: G))),\n";
        let write = |folder: &Path| write_exr(&folder.join("own.exr"), 2, &pixels);
        let app = prepare_files(&[prims, SKY, CAMERA, RENDER], write, |_| ());
        assert_eq!(errors(&app), "");
        assert_eq!(app.world().resource::<Counters>().get("load/textures"), 1);
        app.world().resource::<ComposedScene>().0.hash
    };
    assert_eq!(hash([[0.1; 3], [0.2; 3]]), hash([[0.1; 3], [0.2; 3]]));
    assert_ne!(hash([[0.1; 3], [0.2; 3]]), hash([[0.1; 3], [0.3; 3]]));
}
