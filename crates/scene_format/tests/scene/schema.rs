//! The vocabulary: what is printed, and what is refused when a program starts.

use bevy_reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
use insta::assert_snapshot;
use scene_format::{Schema, SchemaError, schema_text};

use crate::vocabulary::{registry, schema};

#[test]
fn prints_components() {
    let registry = registry();
    let schema = schema(&registry);
    let text = |name| schema_text(&schema, Some(name)).unwrap();
    assert_snapshot!(text("Transform"), @r#"
    Transform
      Where a prim is.
      translate: 3 numbers in m, default (0, 0, 0)
          Position.
      scale: 3 numbers, default (1, 1, 1)
      quaternion: 4 numbers, optional
    "#);
    assert_snapshot!(text("Film"), @r#"
    Film
      resolution: 2 whole numbers from 0, 1 to 65536, default (512, 512)
      filter: one of Box, Triangle, BlackmanHarris, default BlackmanHarris
      filter_radius: a number, above 0, default 1.5
      crop: (2 numbers, 2 numbers), optional
      edges: a list, each a number, default [1, 2, 3]
    "#);
    assert_snapshot!(text("Emission"), @r#"
    Emission
      radiance: 3 numbers in W·m⁻²·sr⁻¹, at least 0, default (0, 0, 0), excludes the other `strength` fields
      power: 3 numbers in W, at least 0, optional, excludes the other `strength` fields
    "#);
    assert_snapshot!(text("LightLinks"), @r#"
    LightLinks
      include: a list of paths of prims, optional
      exclude: a list of paths of prims, default []
    "#);
    assert_snapshot!(text("Render"), @r#"
    Render
      camera: the path of a prim, required
      max_depth: a whole number from 0, optional
      seed: a whole number from 0, default 0
    "#);
    let error = schema_text(&schema, Some("Flim")).unwrap_err();
    assert_eq!(error.suggestion.as_deref(), Some("Film"));
    let all = schema_text(&schema, None).unwrap();
    assert!(all.starts_with("Camera\n") && all.contains("\n\nTransform\n"));
}

mod other {
    use bevy_reflect::{Reflect, std_traits::ReflectDefault};

    #[derive(Reflect, Default)]
    #[reflect(Default)]
    pub(crate) struct Camera;
}

#[derive(Reflect, Default)]
#[reflect(Default)]
struct Camera;

#[derive(Reflect, Default)]
struct NoDefault;

#[derive(Reflect, Default)]
#[reflect(Default)]
struct Pair(f32, f32);

#[derive(Reflect, Default)]
enum Choice {
    #[default]
    Fine,
    Block,
}

#[derive(Reflect, Default)]
#[reflect(Default)]
struct Chooser {
    choice: Option<Choice>,
}

fn refused(fill: impl Fn(&mut TypeRegistry)) -> SchemaError {
    let mut registry = TypeRegistry::new();
    fill(&mut registry);
    let own = |path: &str| path.starts_with(module_path!()) && !path.contains("Choice");
    Schema::new(&registry, |found| own(found.type_info().type_path()))
        .err()
        .expect("a vocabulary that is not sound")
}

#[test]
fn refuses_what_scenes_could_not_write() {
    let clash = refused(|registry| {
        registry.register::<Camera>();
        registry.register::<other::Camera>();
    });
    assert!(matches!(clash, SchemaError::Clash { .. }), "{clash}");
    let none = refused(|registry| registry.register::<NoDefault>());
    assert!(matches!(none, SchemaError::NoDefault { .. }), "{none}");
    let pair = refused(|registry| registry.register::<Pair>());
    assert!(matches!(pair, SchemaError::NotAStruct { .. }), "{pair}");
    let block = refused(|registry| registry.register::<Chooser>());
    assert!(matches!(block, SchemaError::ReservedVariant { .. }), "{block}");
}
