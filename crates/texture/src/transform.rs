use glam::{DAffine2, DMat2, DVec2};
use radiometry::math::sin_cos_f64;

/// How texture coordinates are moved before a picture is looked at: `uv' = T · R · S · uv`.
///
/// It holds where files and glTF count from: the origin at the upper left, v downward.
///
/// Source: `KHR_texture_transform`. Its matrix in GLSL turns the other way than its text ("counter-clockwise") and its
/// example (the lower left quarter, turned clockwise); as viewers do, this follows text and example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureTransform {
    matrix: DAffine2,
}

impl Default for TextureTransform {
    fn default() -> Self {
        Self {
            matrix: DAffine2::IDENTITY,
        }
    }
}

impl TextureTransform {
    /// - `translate`: of the coordinates, in widths and heights of the picture.
    /// - `rotate`: radians, turns the coordinates counter-clockwise and so the picture clockwise.
    /// - `scale`: of the coordinates: 2 shows the picture twice.
    #[must_use]
    pub fn new(translate: DVec2, rotate: f64, scale: DVec2) -> Self {
        let (sin, cos) = sin_cos_f64(rotate);
        let rotation = DMat2::from_cols(DVec2::new(cos, -sin), DVec2::new(sin, cos));
        Self {
            matrix: DAffine2 {
                matrix2: rotation * DMat2::from_diagonal(scale),
                translation: translate,
            },
        }
    }

    /// Where in the picture coordinates with a lower left origin lie: columns and rows as shares from the upper left.
    #[inline]
    #[must_use]
    pub fn place(&self, uv: glam::Vec2) -> DVec2 {
        let uv = uv.as_dvec2();
        self.matrix.transform_point2(DVec2::new(uv.x, 1.0 - uv.y))
    }

    /// The steps in space for a step to the right and one upward in the picture.
    ///
    /// - `dpdu`, `dpdv`: the same for coordinates with a lower left origin.
    /// - returns `None` where the transform leaves no area.
    #[must_use]
    pub fn tangents(&self, dpdu: glam::DVec3, dpdv: glam::DVec3) -> Option<(glam::DVec3, glam::DVec3)> {
        let m = self.matrix.matrix2;
        let determinant = m.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let inverse = m.inverse();
        // Rows run downward, so upward in the picture is the negative of the second coordinate; so it was before.
        let right = dpdu * inverse.x_axis.x - dpdv * inverse.x_axis.y;
        let up = dpdv * inverse.y_axis.y - dpdu * inverse.y_axis.x;
        Some((right, up))
    }
}
