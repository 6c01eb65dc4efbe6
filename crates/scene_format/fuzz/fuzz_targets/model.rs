//! What is done with a model: its layer is written, composed with the renderer's vocabulary, and every mesh that the
//! layer names is read.

use bevy_app::App;
use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy_reflect::std_traits::ReflectDefault;
use pipeline_data::vocabulary::VocabularyPlugin;
use scene_format::{
    MeshLimits, MeshPart, Model, ModelFile, ModelLimits, Options, Schema, load_str, translate_model,
};

/// Reads bytes as the model file `name`; panics where a sound program would not.
pub(crate) fn read_model(name: &str, bytes: &[u8]) {
    let mut app = App::empty();
    app.add_plugins(VocabularyPlugin);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let schema = Schema::new(&registry, |found| {
        found.contains::<ReflectComponent>()
            && found.contains::<ReflectDefault>()
            && !found.type_info().type_path().starts_with("bevy_")
    })
    .expect("the vocabulary is sound");
    let folder = std::env::temp_dir().canonicalize().expect("there is a folder for temporary files");
    let path = folder.join(name);
    let file = ModelFile {
        name,
        path: &path,
        root: &folder,
        bytes,
    };
    let Ok(translated) = translate_model(&file, &schema, &ModelLimits::default()) else {
        return;
    };
    let options = Options {
        check_assets: false,
        ..Options::default()
    };
    let scene = load_str(name, &translated.text, &schema, &options)
        .unwrap_or_else(|errors| panic!("a translated model is a sound layer:\n{errors}"));
    let Ok(mut model) = Model::open(file, &MeshLimits::default()) else {
        return;
    };
    for prim in &scene.prims {
        if let Some(mesh) = prim.component("Mesh") {
            let part = MeshPart {
                mesh: mesh.field("mesh").and_then(|field| field.get_at(0.0)).flatten(),
                primitive: mesh.field("primitive").and_then(|field| field.get_at(0.0)).flatten(),
            };
            drop(model.mesh(&part));
        }
    }
}
