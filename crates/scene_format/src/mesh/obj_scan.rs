//! From the lines of an OBJ file to arrays; every line is checked.

use glam::{DVec2, DVec3};

use super::error::{MeshError, MeshPlace, MeshWarning, Oddity, Problem};
use super::obj_lines::{Lines, keyword_and_rest, words};
use super::obj_parts::ObjParts;
use super::{MeshLimits, obj_text};

/// What stands for a corner's missing normal or texture coordinate.
pub(super) const NONE: u32 = u32::MAX;

/// A face with three corners or more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// From 1.
    pub(super) line: u32,
    pub(super) first_corner: usize,
    pub(super) corners: u32,
}

/// The arrays of an OBJ file.
#[derive(Debug, Default)]
pub(crate) struct ObjFile {
    pub(super) positions: Vec<DVec3>,
    pub(super) uvs: Vec<DVec2>,
    pub(super) normals: Vec<DVec3>,
    /// The line of each normal without length, by the normal's number, rising.
    pub(super) zero_normals: Vec<(u32, u32)>,
    /// Position, texture coordinate and normal of each corner; those that are missing are `NONE`.
    pub(super) corners: Vec<[u32; 3]>,
    pub(super) faces: Vec<Face>,
    pub(super) faces_of_part: Vec<Vec<u32>>,
    /// Faces with fewer than three corners.
    pub(super) few: Tally,
    pub(crate) parts: ObjParts,
}

/// Counts oddities of one kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tally {
    pub(crate) count: usize,
    pub(crate) first: MeshPlace,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            count: 0,
            first: MeshPlace::Line(0),
        }
    }
}

impl Tally {
    pub(crate) fn add(&mut self, place: MeshPlace) {
        if self.count == 0 {
            self.first = place;
        }
        self.count += 1;
    }

    pub(crate) fn warning(&self, oddity: Oddity) -> Option<MeshWarning> {
        (self.count > 0).then_some(MeshWarning {
            oddity,
            count: self.count,
            first: self.first,
        })
    }
}

impl ObjFile {
    /// Reads every line.
    pub(crate) fn parse(file: &str, bytes: &[u8], limits: &MeshLimits) -> Result<Self, MeshError> {
        let text = obj_text(file, bytes, limits.bytes)?;
        let mut read = Self::default();
        read.read_lines(text, limits)
            .and_then(|()| read.check_indices())
            .map_err(|problem| problem.in_file(file))?;
        if read.faces.is_empty() {
            return Err(MeshError::NoFaces { file: file.to_owned() });
        }
        Ok(read)
    }

    fn read_lines(&mut self, text: &str, limits: &MeshLimits) -> Result<(), Problem> {
        let mut triangles = 0_usize;
        for (line, text) in Lines::of(text) {
            let problem = |problem: String| Problem { line, problem };
            let mut words = words(&text);
            match words.next() {
                Some("v") => self.positions.push(position(words).map_err(problem)?),
                Some("vn") => {
                    let normal = DVec3::from_array(numbers(&mut words, 3).map_err(problem)?);
                    if normal == DVec3::ZERO {
                        self.zero_normals.push((self.normals.len() as u32, line as u32));
                    }
                    self.normals.push(normal);
                }
                Some("vt") => {
                    let uv = DVec2::from_array(numbers(&mut words, 1).map_err(problem)?);
                    if uv.abs().max_element() > f64::from(f32::MAX) {
                        return Err(problem("a texture coordinate is at most 3.4e38".to_owned()));
                    }
                    self.uvs.push(uv);
                }
                Some("f") => triangles += self.face(line, words).map_err(problem)?,
                Some("o" | "g" | "usemtl") => {
                    let (keyword, rest) = keyword_and_rest(&text);
                    self.parts.statement(keyword, rest);
                }
                _ => {}
            }
            let most = self.positions.len().max(self.normals.len()).max(self.uvs.len());
            if most > limits.vertices {
                return Err(problem(format!("more than {} vertices", limits.vertices)));
            }
            if triangles > limits.triangles {
                return Err(problem(format!("more than {} triangles", limits.triangles)));
            }
        }
        Ok(())
    }

    /// Reads the corners of a face; returns the number of its triangles.
    fn face<'w>(&mut self, line: usize, words: impl Iterator<Item = &'w str>) -> Result<usize, String> {
        let words: Vec<&str> = words.collect();
        if words.len() < 3 {
            self.few.add(MeshPlace::Line(line));
            return Ok(0);
        }
        let first_corner = self.corners.len();
        for word in &words {
            let corner = self.corner(word)?;
            self.corners.push(corner);
        }
        let part = self.parts.face();
        if part as usize == self.faces_of_part.len() {
            self.faces_of_part.push(Vec::new());
        }
        self.faces_of_part[part as usize].push(self.faces.len() as u32);
        self.faces.push(Face {
            line: line as u32,
            first_corner,
            corners: words.len() as u32,
        });
        Ok(words.len() - 2)
    }

    /// Reads `position/uv/normal`. An index may point to what is written further down, so its end is checked later.
    fn corner(&self, word: &str) -> Result<[u32; 3], String> {
        if word.split('/').count() > 3 {
            return Err(format!("`{}` has more than three parts", shorten(word)));
        }
        let seen = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [NONE; 3];
        for (which, what) in KINDS.into_iter().enumerate() {
            match word.split('/').nth(which) {
                None | Some("") if which > 0 => {}
                text => corner[which] = index(text.unwrap_or(""), seen[which], what)?,
            }
        }
        Ok(corner)
    }

    /// Checks the indices that were written as such; those that count backwards are right already.
    fn check_indices(&self) -> Result<(), Problem> {
        let totals = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for face in &self.faces {
            for corner in &self.corners[face.first_corner..][..face.corners as usize] {
                for (which, what) in KINDS.into_iter().enumerate() {
                    let index = corner[which];
                    if index != NONE && index as usize >= totals[which] {
                        let number = u64::from(index) + 1;
                        return Err(Problem {
                            line: face.line as usize,
                            problem: no_such(what, number, totals[which]),
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

const KINDS: [&str; 3] = ["position", "texture coordinate", "normal"];

fn no_such(what: &str, number: impl std::fmt::Display, total: usize) -> String {
    format!("there is no {what} {number}, the file has {total}")
}

/// Reads an index as one from 0; those below 0 count backwards from what was `seen`.
fn index(text: &str, seen: usize, what: &str) -> Result<u32, String> {
    let number: i64 = text
        .parse()
        .map_err(|_| format!("`{}` is not the number of a {what}", shorten(text)))?;
    if number == 0 {
        return Err("numbers of vertices begin with 1, not 0".to_owned());
    }
    if number < 0 {
        let index = number.checked_add(seen as i64).filter(|index| *index >= 0);
        return match index.and_then(|index| u32::try_from(index).ok()) {
            Some(index) => Ok(index),
            None => Err(format!(
                "there is no {what} {number}: before this line there are {seen}"
            )),
        };
    }
    match u32::try_from(number - 1) {
        Ok(index) if index != NONE => Ok(index),
        _ => Err(format!("there is no {what} {number}; a file has fewer")),
    }
}

/// Reads `x y z`, `x y z w` or `x y z r g b`.
fn position<'w>(mut words: impl Iterator<Item = &'w str>) -> Result<DVec3, String> {
    let position = DVec3::from_array(numbers(&mut words, 3)?);
    let rest: Vec<&str> = words.collect();
    let [w] = rest[..] else {
        return Ok(position);
    };
    let w = number(w)?;
    let divided = position / w;
    if divided.is_finite() {
        Ok(divided)
    } else {
        Err(format!("the weight {w} of this position is too small"))
    }
}

/// Reads `least` to `N` numbers; those that are missing are 0.
pub(crate) fn numbers<'w, const N: usize>(
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
fn shorten(word: &str) -> String {
    let mut short: String = word.chars().take(24).filter(|c| !c.is_control()).collect();
    if word.chars().nth(24).is_some() {
        short.push('…');
    }
    short
}
