//! Choice of a point of a shape by world area.

use super::cone::uniform_scale;
use crate::placed::Pose;
use crate::shapes::{Solid, Spread};
use glam::{DMat3, DVec2, DVec3, Vec2};
use radiometry::Distribution;

/// Cells over the parameters of all faces, weighted by world area.
///
/// Rows (second parameter) are chosen first, then a cell of the row, so that a stratified square stays stratified.
#[derive(Debug)]
pub(super) struct Table {
    faces: Vec<Face>,
    /// Over the rows of all faces, one face after another.
    rows: Distribution,
    /// Face of each row.
    face_of_row: Vec<u32>,
    /// Over the cells of each row.
    cells: Vec<Distribution>,
    cofactor: DMat3,
}

#[derive(Debug)]
struct Face {
    first_row: usize,
    columns: usize,
    rows: usize,
    /// Density per m² where it is the same everywhere.
    even: Option<f32>,
}

impl Table {
    /// `None` when there is no area.
    pub(super) fn new(solid: &Solid, pose: &Pose) -> Option<Self> {
        let cofactor = pose.cofactor();
        let keeps_angles = uniform_scale(pose).is_some();
        let mut table = Self {
            faces: Vec::new(),
            rows: Distribution::default(),
            face_of_row: Vec::new(),
            cells: Vec::new(),
            cofactor,
        };
        let mut weights = Vec::new();
        for index in 0..solid.faces() {
            let (columns, rows) = match (solid.spread(index), keeps_angles) {
                (Spread::Flat, _) | (Spread::AroundAxis | Spread::Sphere, true) => (1, 1),
                (Spread::AroundAxis, false) => (256, 1),
                (Spread::Torus, true) => (1, 256),
                (Spread::Sphere | Spread::Torus, false) => (64, 64),
            };
            let first_row = weights.len();
            let area = solid.face_area(index, &cofactor);
            for row in 0..rows {
                let weight = |column: usize| {
                    let u = DVec2::new((column as f64 + 0.5) / columns as f64, (row as f64 + 0.5) / rows as f64);
                    (cofactor * solid.point(index, u).1).length()
                };
                let cells = Distribution::new((0..columns).map(weight));
                // Rows of a single face of a single cell weigh exactly their area; the rest in proportion.
                let share = if columns * rows == 1 {
                    area
                } else {
                    cells.total() / (columns * rows) as f64
                };
                weights.push(share);
                table.cells.push(cells);
                table.face_of_row.push(index);
            }
            table.faces.push(Face {
                first_row,
                columns,
                rows,
                even: (columns * rows == 1).then_some(area as f32),
            });
        }
        table.rows = Distribution::new(weights);
        for face in &mut table.faces {
            let probability = table.rows.probability(face.first_row);
            face.even = face.even.map(|area| probability / area);
        }
        (!table.rows.is_empty()).then_some(table)
    }

    /// Chooses a face and parameters on it.
    pub(super) fn sample(&self, u: Vec2) -> (u32, DVec2) {
        let (row, _, rest_y) = self.rows.sample(u.y).unwrap_or((0, 1.0, u.y));
        let (column, _, rest_x) = self.cells[row].sample(u.x).unwrap_or((0, 1.0, u.x));
        let index = self.face_of_row[row];
        let face = &self.faces[index as usize];
        let parameters = DVec2::new(
            (column as f64 + f64::from(rest_x)) / face.columns as f64,
            ((row - face.first_row) as f64 + f64::from(rest_y)) / face.rows as f64,
        );
        (index, parameters)
    }

    /// Density per m² with which a point is chosen; `local` yields it in object space, where that is needed.
    pub(super) fn pdf_area(&self, solid: &Solid, face: u32, local: impl FnOnce() -> DVec3) -> f32 {
        let Some(layout) = self.faces.get(face as usize) else {
            return 0.0;
        };
        if let Some(even) = layout.even {
            return even;
        }
        let u = solid.parameters(face, local());
        let column = ((u.x * layout.columns as f64) as usize).min(layout.columns - 1);
        let row = layout.first_row + ((u.y * layout.rows as f64) as usize).min(layout.rows - 1);
        let cell = f64::from(self.rows.probability(row)) * f64::from(self.cells[row].probability(column));
        let element = (self.cofactor * solid.point(face, u).1).length();
        (cell * (layout.columns * layout.rows) as f64 / element) as f32
    }
}
