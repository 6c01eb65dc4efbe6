//! Under construction.
use bevy_app::{App, Plugin};

/// Under construction.
pub struct TablesPlugin;

impl Plugin for TablesPlugin {
    fn build(&self, _app: &mut App) {}
}
