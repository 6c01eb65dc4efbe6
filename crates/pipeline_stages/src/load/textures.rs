use super::import::{read, shown_path};
use bevy_ecs::prelude::*;
use pipeline_core::{Counters, Report};
use pipeline_data::vocabulary::{Diffuse, Findings, Principled, TextureMap, field_place};
use pipeline_data::{ComposedScene, PictureKey, PrimIndex, RenderRequest, TextureStore};
use rayon::prelude::*;
use scene_format::{Diagnostic, MeshLimits, Model, ModelFile, Place, Scene, is_model};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use texture::{Picture, PictureLimits, decode};

type TexturedPrim<'a> = (&'a PrimIndex, Option<&'a Diffuse>, Option<&'a Principled>);
type MayBeTextured = Or<(With<Diffuse>, With<Principled>)>;

/// A file to read.
struct Wanted {
    path: PathBuf,
    /// Each picture of it, with the first field that names it.
    pictures: BTreeMap<Option<u32>, Option<Place>>,
}

/// A file that was read.
struct Imported {
    /// What goes into the hash.
    bytes: Vec<Vec<u8>>,
    /// In the order of what is wanted, or what is wrong.
    pictures: Vec<Result<Picture, String>>,
}

/// Loads what each texture names, every picture once, and mixes the bytes of the files into the scene's hash.
///
/// Pictures are decoded in parallel; store and hash are filled in the order in which the prims name the files.
pub(super) fn import_textures(
    mut commands: Commands,
    request: Res<RenderRequest>,
    mut composed: ResMut<ComposedScene>,
    mut report: ResMut<Report>,
    mut counters: ResMut<Counters>,
    materials: Query<TexturedPrim<'_>, MayBeTextured>,
) {
    let mut findings = Findings::default();
    let mut rows: Vec<_> = materials.iter().collect();
    rows.sort_by_key(|(index, ..)| **index);
    let mut files = Files::default();
    for (index, diffuse, principled) in rows {
        let of = |component, (field, map)| (component, field, map);
        let diffuse = diffuse
            .into_iter()
            .flat_map(Diffuse::textures)
            .map(|found| of("Diffuse", found));
        let principled = principled.into_iter().flat_map(Principled::textures);
        for (component, field, map) in diffuse.chain(principled.map(|found| of("Principled", found))) {
            let place = field_place(&composed.0, index.0, component, &[field]);
            files.add(map, place, &mut findings);
        }
    }
    let limits = PictureLimits::of_pixels(request.options.limits.texture_pixels as u64);
    let imported: Vec<_> = files
        .wanted
        .par_iter()
        .map(|file| file.import(&composed.0, &request.scene, &limits))
        .collect();
    let mut store = TextureStore::default();
    for (file, imported) in files.wanted.into_iter().zip(imported) {
        for bytes in &imported.bytes {
            composed.0.mix_file("texture", bytes);
        }
        let shown = shown_path(&file.path, &request.scene);
        for ((image, place), picture) in file.pictures.into_iter().zip(imported.pictures) {
            match picture {
                Ok(picture) => {
                    let path = file.path.clone();
                    store.insert(PictureKey { path, image }, picture);
                }
                Err(error) => findings.push_at(place, bad_texture(&shown, image, &error)),
            }
        }
    }
    counters.counter("load/textures").add(store.len() as u64);
    findings.file(&composed.0, &request, &mut report);
    commands.insert_resource(store);
}

fn bad_texture(shown: &str, image: Option<u32>, error: &str) -> Diagnostic {
    let image = image.map_or(String::new(), |image| format!(", image {image}"));
    Diagnostic::error("bad-texture", format!("{shown}{image}: {error}"))
}

/// Files by their order, each once.
#[derive(Default)]
struct Files {
    wanted: Vec<Wanted>,
    row_of: BTreeMap<PathBuf, usize>,
}

impl Files {
    fn add(&mut self, map: &TextureMap, place: Option<Place>, findings: &mut Findings) {
        let key = PictureKey::from(map);
        match (is_model(&key.path), map.image) {
            (true, None) => {
                let finding = Diagnostic::error("missing-field", "a model file holds any number of pictures")
                    .note("name one by its number, from 0: `(file: \"..\", image: 0)`");
                return findings.push_at(place, finding);
            }
            (false, Some(_)) => {
                let finding = Diagnostic::error("exclusive-fields", "`image` is for `.gltf` and `.glb` files")
                    .note("leave it out: this file is one picture");
                return findings.push_at(place, finding);
            }
            _ => {}
        }
        let next = self.wanted.len();
        let row = *self.row_of.entry(key.path.clone()).or_insert(next);
        if row == next {
            self.wanted.push(Wanted {
                path: key.path,
                pictures: BTreeMap::new(),
            });
        }
        self.wanted[row].pictures.entry(key.image).or_insert(place);
    }
}

impl Wanted {
    fn import(&self, scene: &Scene, request: &Path, limits: &PictureLimits) -> Imported {
        let read = if is_model(&self.path) {
            self.read_model(scene, &shown_path(&self.path, request))
        } else {
            read_picture(&self.path, limits).map(|bytes| vec![Ok(bytes)])
        };
        let encoded = match read {
            Ok(read) => read,
            Err(error) => {
                return Imported {
                    bytes: Vec::new(),
                    pictures: self.pictures.iter().map(|_| Err(error.clone())).collect(),
                };
            }
        };
        let decode_one = |bytes: &Result<Vec<u8>, String>| {
            let bytes = bytes.as_ref().map_err(Clone::clone)?;
            decode(bytes, limits).map_err(|error| error.to_string())
        };
        let pictures = encoded.par_iter().map(decode_one).collect();
        Imported {
            bytes: encoded.into_iter().flatten().collect(),
            pictures,
        }
    }

    /// The bytes of the images that are wanted of a model file; those are all that is hashed of it.
    fn read_model(&self, scene: &Scene, shown: &str) -> Result<Vec<Result<Vec<u8>, String>>, String> {
        let limits = MeshLimits::default();
        let bytes = read(&self.path, limits.bytes).map_err(|error| error.to_string())?;
        let file = ModelFile {
            name: shown,
            path: &self.path,
            root: scene.root(),
            bytes: &bytes,
        };
        let mut model = Model::open(file, &limits).map_err(|error| error.to_string())?;
        let images = self.pictures.keys().flatten();
        let images = images.map(|image| model.image(*image).map_err(|error| error.to_string()));
        Ok(images.collect())
    }
}

/// Reads the bytes of a picture, as many as any within the limits has.
pub(super) fn read_picture(path: &Path, limits: &PictureLimits) -> Result<Vec<u8>, String> {
    let most = limits.file_bytes();
    let bytes = read(path, most).map_err(|error| format!("it cannot be read: {error}"))?;
    if bytes.len() as u64 > most {
        return Err(format!(
            "it has more than {most} bytes; scale the picture down, or raise the limit `texture_pixels`"
        ));
    }
    Ok(bytes)
}
