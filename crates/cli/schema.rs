//! `pipeline schema`: what a scene can say, from the registered types.

use crate::args::SchemaArgs;
use crate::exit::Failure;
use crate::session;
use crate::terminal::{print, use_colour};
use bevy_ecs::reflect::AppTypeRegistry;
use pipeline_data::vocabulary::is_scene_component;
use scene_format::{Schema, Sources, schema_text};

pub(crate) fn execute(options: &SchemaArgs) -> Result<(), Failure> {
    let app = session::new_app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let schema = Schema::new(&registry, is_scene_component).map_err(|error| Failure::failed(error.to_string()))?;
    let text = schema_text(&schema, options.component.as_deref())
        .map_err(|error| Failure::bad_input(error.render(&Sources::default(), use_colour())))?;
    print(&text)
}
