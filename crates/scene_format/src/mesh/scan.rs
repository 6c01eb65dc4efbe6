//! First pass: how much there is, and that every number is one.

use super::MeshLimits;
use super::error::{MeshWarning, Oddity, Problem};
use super::lines::{Lines, words};

/// What a file holds.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub(super) positions: usize,
    pub(super) normals: usize,
    pub(super) uvs: usize,
    /// Faces with three corners or more.
    pub(super) faces: usize,
    pub(super) use_normals: bool,
    pub(super) use_uvs: bool,
    pub(super) warnings: Vec<MeshWarning>,
}

/// Counts oddities of one kind.
#[derive(Default)]
pub(super) struct Tally {
    pub(super) count: usize,
    pub(super) first: usize,
}

impl Tally {
    pub(super) fn add(&mut self, line: usize) {
        if self.count == 0 {
            self.first = line;
        }
        self.count += 1;
    }

    pub(super) fn warning(&self, oddity: Oddity) -> Option<MeshWarning> {
        (self.count > 0).then_some(MeshWarning {
            oddity,
            count: self.count,
            line: self.first,
        })
    }
}

/// Reads every line once.
pub(super) fn scan(text: &str, limits: &MeshLimits) -> Result<Contents, Problem> {
    let mut contents = Contents::default();
    let mut triangles = 0_usize;
    let [mut few, mut zero, mut bare_normals, mut bare_uvs] = <[Tally; 4]>::default();
    for (line, text) in Lines::of(text) {
        let problem = |problem: String| Problem { line, problem };
        let mut words = words(&text);
        match words.next() {
            Some("v") => {
                position(words).map_err(problem)?;
                contents.positions += 1;
            }
            Some("vn") => {
                let [x, y, z] = numbers(&mut words, 3).map_err(problem)?;
                if x == 0.0 && y == 0.0 && z == 0.0 {
                    zero.add(line);
                }
                contents.normals += 1;
            }
            Some("vt") => {
                numbers::<2>(&mut words, 1).map_err(problem)?;
                contents.uvs += 1;
            }
            Some("f") => {
                let corners: Vec<&str> = words.collect();
                if corners.len() < 3 {
                    few.add(line);
                    continue;
                }
                contents.faces += 1;
                triangles += corners.len() - 2;
                if corners.iter().any(|corner| part(corner, 2).is_empty()) {
                    bare_normals.add(line);
                }
                if corners.iter().any(|corner| part(corner, 1).is_empty()) {
                    bare_uvs.add(line);
                }
            }
            _ => {}
        }
        let most = contents.positions.max(contents.normals).max(contents.uvs);
        if most > limits.vertices {
            return Err(problem(format!("more than {} vertices", limits.vertices)));
        }
        if triangles > limits.triangles {
            return Err(problem(format!("more than {} triangles", limits.triangles)));
        }
    }
    contents.use_normals = contents.normals > 0 && bare_normals.count == 0 && zero.count == 0;
    contents.use_uvs = contents.uvs > 0 && bare_uvs.count == 0;
    contents.warnings.extend(few.warning(Oddity::FewCorners));
    if contents.normals > 0 && bare_normals.count < contents.faces {
        contents.warnings.extend(bare_normals.warning(Oddity::PartialNormals));
        contents.warnings.extend(zero.warning(Oddity::ZeroNormal));
    }
    if contents.uvs > 0 && bare_uvs.count < contents.faces {
        contents.warnings.extend(bare_uvs.warning(Oddity::PartialUvs));
    }
    Ok(contents)
}

/// Gives one of the parts of `position/uv/normal`.
pub(super) fn part(corner: &str, which: usize) -> &str {
    corner.split('/').nth(which).unwrap_or("")
}

/// Reads `x y z`, `x y z w` or `x y z r g b`.
pub(super) fn position<'w>(mut words: impl Iterator<Item = &'w str>) -> Result<[f64; 3], String> {
    let [x, y, z] = numbers(&mut words, 3)?;
    let rest: Vec<&str> = words.collect();
    let [w] = rest[..] else {
        return Ok([x, y, z]);
    };
    let w = number(w)?;
    let divided = [x / w, y / w, z / w];
    if divided.iter().all(|number| number.is_finite()) {
        Ok(divided)
    } else {
        Err(format!("the weight {w} of this position is too small"))
    }
}

/// Reads `least` to `N` numbers; those that are missing are 0.
pub(super) fn numbers<'w, const N: usize>(
    words: &mut impl Iterator<Item = &'w str>,
    least: usize,
) -> Result<[f64; N], String> {
    let mut all = [0.0; N];
    for (at, place) in all.iter_mut().enumerate() {
        match words.next() {
            Some(word) => *place = number(word)?,
            None if at < least => {
                let plural = if least == 1 { "" } else { "s" };
                return Err(format!("expected {least} number{plural}, found {at}"));
            }
            None => break,
        }
    }
    Ok(all)
}

fn number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("`{word}` is not a finite number")),
        Err(_) => Err(format!("`{}` is not a number", shorten(word))),
    }
}

/// Keeps messages about binary files short.
pub(super) fn shorten(word: &str) -> String {
    let mut short: String = word.chars().take(24).filter(|c| !c.is_control()).collect();
    if word.chars().nth(24).is_some() {
        short.push('…');
    }
    short
}
