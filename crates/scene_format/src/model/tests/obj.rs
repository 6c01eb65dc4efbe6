//! OBJ files and their material libraries.

use glam::Vec3;

use super::vocabulary::{Conductor, Dielectric, Diffuse, Emission, MaterialBinding, Mesh, component, compose, paths};
use super::*;

const CORNERS: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n";

/// Translates a text beside a library `a.mtl`.
fn translated(obj: &str, mtl: &str) -> TranslatedModel {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    std::fs::write(root.join("a.mtl"), mtl).unwrap();
    let path = root.join("box.obj");
    let bytes = obj.as_bytes();
    with_schema(|schema| translate_model(&file(&path, &root, bytes), schema, &ModelLimits::default())).unwrap()
}

#[test]
fn a_plain_file_is_one_prim() {
    let found = translated(&format!("{CORNERS}f 1 2 3 4\n"), "");
    insta::assert_snapshot!(found.text, @r#"
    Layer(
        default_prim: "box",
        prims: {
            "/box": Def(
                Mesh: (file: "box.obj"),
            ),
        },
    )
    "#);
    assert!(found.warnings.is_empty() && found.files.is_empty());
}

#[test]
fn objects_and_materials_become_prims() {
    let obj = format!(
        "mtllib a.mtl\n{CORNERS}o Left side\nusemtl Red\nf 1 2 3\no B\nusemtl Red\nf 1 2 3\nusemtl Lamp\nf 1 3 4\n\
         o Left side\nusemtl Red\nf 1 3 4\n"
    );
    let found = translated(&obj, "newmtl Red\nKd 1 0 0\nnewmtl Lamp\nKd 0 0 0\nKe 5 4 3\n");
    assert_eq!(found.files.len(), 1);
    assert_eq!(warnings(&found), [""; 0]);
    let scene = compose(&found.text);
    assert_eq!(
        paths(&scene),
        [
            "/box",
            "/box/Left_side",
            "/box/B",
            "/box/B/Red",
            "/box/B/Lamp",
            "/box/Materials",
            "/box/Materials/Red",
            "/box/Materials/Lamp",
        ]
    );
    let left: Mesh = component(&scene, "/box/Left_side", "Mesh");
    assert_eq!((left.mesh.as_deref(), left.primitive), (Some("Left side"), None));
    let lamp: Mesh = component(&scene, "/box/B/Lamp", "Mesh");
    assert_eq!((lamp.mesh.as_deref(), lamp.primitive), (Some("B"), Some(1)));
    let bound: MaterialBinding = component(&scene, "/box/B/Lamp", "MaterialBinding");
    assert_eq!(bound.target.0, "/box/Materials/Lamp");
    let light: Emission = component(&scene, "/box/B/Lamp", "Emission");
    assert_eq!(light.radiance, Vec3::new(5.0, 4.0, 3.0));

    let triangles = |name: Option<&str>, primitive| {
        let found = mesh("box.obj", obj.as_bytes(), name, primitive).map_err(|error| error.to_string());
        found.map(|found| found.triangles.len())
    };
    assert_eq!(triangles(None, None), Ok(4));
    assert_eq!(triangles(Some("Left side"), None), Ok(2));
    assert_eq!(triangles(Some("#1"), Some(1)), Ok(1));
    assert_eq!(triangles(Some("B"), None), Ok(2));
    assert_eq!(
        triangles(Some("C"), None).unwrap_err(),
        "box.obj: there is no object or group \"C\"; did you mean \"B\"?"
    );
    assert!(
        triangles(Some("B"), Some(2))
            .unwrap_err()
            .contains("there is no part 2")
    );
    assert!(triangles(None, Some(0)).unwrap_err().contains("there are 2 objects"));
}

#[test]
fn parts_keep_the_normals_that_only_they_have() {
    let obj = format!("{CORNERS}vn 0 0 1\ng a\nf 1//1 2//1 3//1\ng b\nf 1 3 4\n");
    let read = |name| mesh("box.obj", obj.as_bytes(), name, None).unwrap();
    assert!(read(Some("a")).normals.is_some());
    assert!(read(Some("b")).normals.is_none() && read(Some("b")).warnings.is_empty());
    assert!(read(None).normals.is_none() && read(None).warnings.len() == 1);
}

#[test]
fn materials_become_the_nearest_component() {
    let obj = format!("mtllib a.mtl\n{CORNERS}f 1 2 3\n");
    let scene = |mtl: &str| compose(&translated(&obj, &format!("newmtl m\n{mtl}")).text);
    let path = "/box/Materials/m";
    let matt: Diffuse = component(&scene("Kd 0.25 0.5 2\nNs 10\n"), path, "Diffuse");
    assert_eq!(matt.albedo, Vec3::new(0.25, 0.5, 1.0));
    let glass: Dielectric = component(&scene("illum 7\nNi 1.45\nNs 2000\n"), path, "Dielectric");
    assert_eq!((glass.ior, glass.roughness, glass.thin), (1.45, 0.0, false));
    let sheer: Dielectric = component(&scene("Kd 1 0 0\nTr 0.75\n"), path, "Dielectric");
    assert_eq!(
        (sheer.ior, sheer.tint, sheer.thin),
        (1.0, Vec3::new(1.0, 0.75, 0.75), true)
    );
    let mirror: Conductor = component(&scene("illum 3\nKd 0 0 0\nKs .9\nNs 30\n"), path, "Conductor");
    assert_eq!((mirror.f0, mirror.roughness), (Some(Vec3::splat(0.9)), 0.5));
    let metal: Conductor = component(&scene("Kd 1 .5 0\nPm 1\nPr .3\n"), path, "Conductor");
    assert_eq!((metal.f0, metal.roughness), (Some(Vec3::new(1.0, 0.5, 0.0)), 0.3));
}

#[test]
fn what_is_missing_is_a_warning() {
    let obj = format!("mtllib b.mtl ../c.mtl a.mtl\nusemtl steel\n{CORNERS}f 1 2 3\nmtllib a.mtl\n");
    let found = translated(&obj, "Kd 1 1 1\nnewmtl m\nKd 1 x\nmap_Kd a.png\nmap_Bump a.png\n");
    assert_eq!(found.files.len(), 1);
    assert_eq!(warnings(&found).len(), 6);
    assert!(warnings(&found)[1].starts_with("line 1: no materials: `../c.mtl` lies outside of "));
    for part in [
        "line 1: no materials: there is no file `b.mtl`, did you mean `a.mtl`?",
        "a.mtl:3: `x` is not a number, so `Kd` is left out",
        "no library has these materials: \"steel\"",
        "a.mtl:4: there is no file `a.png`, so `map_Kd` is left out",
        "not supported yet, so left out: textures other than `map_Kd` of matt materials",
    ] {
        assert!(warnings(&found).iter().any(|warning| warning == part), "{part}");
    }
}

#[test]
fn a_picture_of_the_matt_colour_is_a_texture() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    std::fs::create_dir(root.join("lib")).unwrap();
    std::fs::write(root.join("lib/wood grain.png"), "").unwrap();
    let mtl = "newmtl a\nmap_Kd wood grain.png\nnewmtl b\nKd .5 .5 .25\nmap_Kd .\\wood grain.png\n\
               newmtl c\nKd .5 .5 .5\nmap_Kd -s 2 2 2 wood grain.png\nnewmtl d\nmap_Kd wood.tga\n\
               newmtl e\nmap_Kd /wood.png\nnewmtl f\nPm 1\nmap_Kd wood grain.png\n";
    std::fs::write(root.join("lib/a.mtl"), mtl).unwrap();
    let path = root.join("box.obj");
    let obj = format!("mtllib lib/a.mtl\n{CORNERS}f 1 2 3\n");
    let found = with_schema(|schema| {
        let file = file(&path, &root, obj.as_bytes());
        translate_model(&file, schema, &ModelLimits::default()).unwrap()
    });
    let scene = compose(&found.text);
    let matt = |name: &str| component::<Diffuse>(&scene, &format!("/box/Materials/{name}"), "Diffuse");
    let plain = matt("a").albedo_texture.unwrap();
    assert_eq!((&plain.file.0[..], plain.factor), ("lib/wood grain.png", None));
    let tinted = matt("b").albedo_texture.unwrap();
    assert_eq!(
        (&tinted.file.0[..], tinted.factor),
        ("lib/./wood grain.png", Some(Vec3::new(0.5, 0.5, 0.25)))
    );
    assert_eq!((matt("c").albedo, matt("c").albedo_texture), (Vec3::splat(0.5), None));
    insta::assert_snapshot!(warnings(&found).join("\n"), @r#"
    lib/a.mtl:8: options of textures are not supported, so `map_Kd` is left out
    lib/a.mtl:10: "wood.tga" is no PNG, JPEG, EXR or HDR file, so `map_Kd` is left out
    lib/a.mtl:12: `/wood.png` is absolute, so `map_Kd` is left out
    not supported yet, so left out: textures other than `map_Kd` of matt materials
    "#);
}

#[test]
fn many_libraries_are_not_looked_for() {
    let obj = format!("{}{CORNERS}f 1 2 3\n", "mtllib x y z\n".repeat(20_000));
    assert_eq!(translated(&obj, "").warnings.len(), 100);
}

#[test]
fn files_that_are_no_models() {
    let said = |name: &str, bytes: &[u8]| translate(name, bytes).unwrap_err().to_string();
    assert_eq!(
        said("a.obj", b"v 0 0 0\n"),
        "a.obj has no faces; a mesh needs lines such as `f 1 2 3`"
    );
    assert!(said("a.obj", b"\n\xff").starts_with("a.obj:2: this is not UTF-8"));
    assert!(said("a.ply", b"ply").contains("does not end in"));
    assert!(said("a:b.obj", b"").contains("rename the file"));
    assert!(is_model(Path::new("A.GLB")) && !is_model(Path::new("obj")));
}
