//! The hash of a composed scene, which names what was rendered.

use bevy_reflect::{PartialReflect, ReflectRef};
use sha2::{Digest, Sha256};
use std::path::Path;

use crate::layer::{Specifier, TimeSettings};
use crate::relation::AssetPath;
use crate::scene::{ComponentValue, FieldState, FieldValue, Prim, Scene};

/// Mixes the bytes of a file, or anything else that the picture depends on, into a scene's hash.
pub fn mix_hash(hash: &mut [u8; 32], label: &str, bytes: &[u8]) {
    let mut writer = Writer::default();
    writer.bytes(&*hash);
    writer.text(label);
    writer.bytes(bytes);
    *hash = writer.finish();
}

impl Scene {
    /// Mixes the bytes of a file that the scene names into its hashes.
    pub fn mix_file(&mut self, label: &str, bytes: &[u8]) {
        let digest: [u8; 32] = Sha256::digest(bytes).into();
        mix_hash(&mut self.hash, label, &digest);
        mix_hash(&mut self.files, label, &digest);
    }

    /// Hashes a part of what takes part in the picture: the same for the same values, wherever else the scene differs, and
    /// at whichever frame where nothing in that part changes over time. All files that were mixed in count.
    ///
    /// - `takes`: whether a component of a prim (by its index) counts, and then, of each field with an opinion, whether
    ///   that does.
    #[must_use]
    pub fn hash_of_part(&self, takes: impl Fn(usize, &ComponentValue, Option<&FieldValue>) -> bool) -> [u8; 32] {
        let mut writer = Writer::default();
        let mut changes = false;
        for (index, prim) in self.rendered() {
            for component in prim.components.iter().filter(|component| takes(index, component, None)) {
                writer.text(&prim.path);
                write_fields(&mut writer, component, self.root(), |field| {
                    let is_taken = takes(index, component, Some(field));
                    changes |= is_taken && field.samples().is_some();
                    is_taken
                });
            }
        }
        if changes {
            for number in [self.time.start, self.time.end, self.time.fps, self.frame] {
                writer.float(number);
            }
        }
        writer.bytes(&self.files);
        writer.finish()
    }
}

/// Writes values so that different ones never look the same: every part has its length before it.
#[derive(Default)]
struct Writer(Sha256);

impl Writer {
    fn bytes(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    fn count(&mut self, count: usize) {
        self.0.update((count as u64).to_le_bytes());
    }

    fn float(&mut self, number: f64) {
        self.0.update(number.to_bits().to_le_bytes());
    }

    fn finish(self) -> [u8; 32] {
        self.0.finalize().into()
    }
}

/// Hashes prims, components and winning values; not comments, labels, formatting or places.
pub(crate) fn hash_scene(prims: &[Prim], time: TimeSettings, root: &Path) -> [u8; 32] {
    let mut writer = Writer::default();
    for number in [time.start, time.end, time.fps] {
        writer.float(number);
    }
    writer.count(prims.len());
    for prim in prims {
        writer.text(&prim.path);
        writer.text(match prim.specifier {
            Specifier::Def => "def",
            Specifier::Over => "over",
            Specifier::Class => "class",
        });
        writer.count(usize::from(prim.rendered));
        writer.count(prim.components.len());
        for component in &prim.components {
            write_component(&mut writer, component, root);
        }
    }
    writer.finish()
}

fn write_component(writer: &mut Writer, component: &ComponentValue, root: &Path) {
    write_fields(writer, component, root, |_| true);
}

fn write_fields(
    writer: &mut Writer,
    component: &ComponentValue,
    root: &Path,
    mut takes: impl FnMut(&FieldValue) -> bool,
) {
    writer.text(component.name);
    let authored = component
        .fields
        .iter()
        .filter(|field| !matches!(field.state, FieldState::Blocked));
    for field in authored {
        if !takes(field) {
            continue;
        }
        writer.text(field.name);
        match &field.state {
            FieldState::Constant(value) => write_value(writer, &**value, root),
            FieldState::Samples(samples) => {
                writer.text("samples");
                writer.count(samples.len());
                for (time, value) in samples {
                    writer.float(*time);
                    write_value(writer, &**value, root);
                }
            }
            FieldState::Blocked => {}
        }
    }
    writer.text("");
}

fn write_value(writer: &mut Writer, value: &dyn PartialReflect, root: &Path) {
    if let Some(AssetPath(path)) = value.try_downcast_ref() {
        let below = Path::new(path).strip_prefix(root).unwrap_or(Path::new(path));
        let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
        return writer.text(&parts.join("/"));
    }
    match value.reflect_ref() {
        ReflectRef::Struct(parts) => {
            writer.count(parts.field_len());
            for (name, part) in parts.iter_fields() {
                writer.text(name);
                write_value(writer, part, root);
            }
        }
        ReflectRef::TupleStruct(parts) => {
            writer.count(parts.field_len());
            parts.iter_fields().for_each(|part| write_value(writer, part, root));
        }
        ReflectRef::Tuple(parts) => {
            writer.count(parts.field_len());
            parts.iter_fields().for_each(|part| write_value(writer, part, root));
        }
        ReflectRef::List(parts) => {
            writer.count(parts.len());
            parts.iter().for_each(|part| write_value(writer, part, root));
        }
        ReflectRef::Array(parts) => {
            writer.count(parts.len());
            parts.iter().for_each(|part| write_value(writer, part, root));
        }
        ReflectRef::Enum(parts) => {
            writer.text(parts.variant_name());
            writer.count(parts.field_len());
            parts
                .iter_fields()
                .for_each(|part| write_value(writer, part.value(), root));
        }
        // Sets and maps have an order of their own; sorted by what is written of them.
        ReflectRef::Map(parts) => {
            let mut entries: Vec<[u8; 32]> = parts
                .iter()
                .map(|(key, part)| {
                    let mut entry = Writer::default();
                    write_value(&mut entry, key, root);
                    write_value(&mut entry, part, root);
                    entry.finish()
                })
                .collect();
            entries.sort_unstable();
            entries.iter().for_each(|entry| writer.bytes(entry));
        }
        ReflectRef::Set(parts) => {
            let mut entries: Vec<[u8; 32]> = parts
                .iter()
                .map(|part| {
                    let mut entry = Writer::default();
                    write_value(&mut entry, part, root);
                    entry.finish()
                })
                .collect();
            entries.sort_unstable();
            entries.iter().for_each(|entry| writer.bytes(entry));
        }
        _ => write_leaf(writer, value),
    }
}

fn write_leaf(writer: &mut Writer, value: &dyn PartialReflect) {
    if let Some(text) = value.try_downcast_ref::<String>() {
        return writer.text(text);
    }
    // Shortest decimal texts tell all numbers of one type apart.
    writer.text(&format!("{value:?}"));
}
