//! From where to look at a model: by its camera, or so that its bounding box fills the picture.
//!
//! The file is read on its own, so that a mistake of the renderer's reader is not repeated here.

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

/// Angle of view in degrees, in both directions.
pub(crate) const FOV: f64 = 30.0;

/// Towards the camera: the samples face +Z.
const TOWARDS: DVec3 = DVec3::new(0.2, 0.15, 1.0);

/// Distance in multiples of the least one that shows everything.
const MARGIN: f64 = 1.05;

/// How to look at a model.
pub(crate) enum View {
    /// By the camera at this path below the prim of the model.
    Camera(String),
    /// From one point at another.
    Looking {
        /// The camera.
        from: DVec3,
        /// The middle of the picture.
        at: DVec3,
    },
}

/// Chooses a view of a model file, which must be right.
pub(crate) fn view(bytes: &[u8], is_container: bool) -> View {
    let json = if is_container {
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap());
        &bytes[20..20 + length as usize]
    } else {
        bytes
    };
    let mut model = Model {
        json: serde_json::from_slice(json).unwrap(),
        corners: Vec::new(),
        camera: None,
    };
    let roots = model.json["scenes"][0]["nodes"].clone();
    model.visit(&roots, DMat4::IDENTITY, "");
    match model.camera {
        Some(path) => View::Camera(path),
        None => fitting(&model.corners),
    }
}

struct Model {
    json: Value,
    /// Corners of the boxes of all meshes, in the space of the scene.
    corners: Vec<DVec3>,
    /// The path of the first camera with a perspective.
    camera: Option<String>,
}

impl Model {
    fn visit(&mut self, nodes: &Value, above: DMat4, path: &str) {
        for number in nodes.as_array().into_iter().flatten() {
            let node = self.json["nodes"][number.as_u64().unwrap() as usize].clone();
            let name = match node["name"].as_str() {
                Some(name) => name.to_owned(),
                None => format!("Node{number}"),
            };
            let path = format!("{path}/{name}");
            let placed = above * placement(&node);
            if let Some(mesh) = node["mesh"].as_u64() {
                self.add_mesh(mesh as usize, placed);
            }
            if let Some(camera) = node["camera"].as_u64()
                && self.json["cameras"][camera as usize]["type"] == "perspective"
            {
                self.camera.get_or_insert(path.clone());
            }
            self.visit(&node["children"], placed, &path);
        }
    }

    fn add_mesh(&mut self, mesh: usize, placed: DMat4) {
        for primitive in self.json["meshes"][mesh]["primitives"].as_array().unwrap() {
            let accessor = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
            let accessor = &self.json["accessors"][accessor];
            let [low, high] = ["min", "max"].map(|end| DVec3::from_array(array(&accessor[end]).unwrap()));
            for corner in 0..8 {
                let side = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
                self.corners
                    .push(placed.transform_point3(DVec3::new(side(0), side(1), side(2))));
            }
        }
    }
}

fn array<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let numbers: Vec<f64> = value.as_array()?.iter().filter_map(Value::as_f64).collect();
    numbers.try_into().ok()
}

fn placement(node: &Value) -> DMat4 {
    if let Some(matrix) = array(&node["matrix"]) {
        return DMat4::from_cols_array(&matrix);
    }
    DMat4::from_scale_rotation_translation(
        array(&node["scale"]).map_or(DVec3::ONE, DVec3::from_array),
        array(&node["rotation"]).map_or(DQuat::IDENTITY, DQuat::from_array),
        array(&node["translation"]).map_or(DVec3::ZERO, DVec3::from_array),
    )
}

/// Steps back from the middle until every corner is in view.
fn fitting(corners: &[DVec3]) -> View {
    let low = corners.iter().copied().reduce(DVec3::min).unwrap();
    let high = corners.iter().copied().reduce(DVec3::max).unwrap();
    let at = (low + high) / 2.0;
    let back = TOWARDS.normalize();
    let right = DVec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let slope = radiometry::math::tan_f64((FOV / 2.0).to_radians());
    let distance = corners.iter().map(|corner| {
        let offset = *corner - at;
        offset.dot(back) + offset.dot(right).abs().max(offset.dot(up).abs()) / slope
    });
    let distance = distance.fold(0.0, f64::max) * MARGIN;
    View::Looking {
        from: at + back * distance,
        at,
    }
}
