//! Second pass: checked lines to `tobj`, its arrays to a mesh.

use std::fmt::Write;
use std::io::{self, BufRead, Read};

use glam::{DVec2, DVec3};

use super::ObjMesh;
use super::error::{MeshError, Oddity, Problem};
use super::lines::{Lines, words};
use super::scan::{Contents, Tally, numbers, part, position, shorten};

/// Sine of the least angle that a triangle with an area has.
const LEAST_SINE: f64 = 1e-12;

/// Builds the mesh of a text that was scanned.
pub(super) fn build(file: &str, text: &str, contents: &Contents) -> Result<ObjMesh, MeshError> {
    let mut checked = Checked::of(text, contents);
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    let read = tobj::load_obj_buf(&mut checked, &options, |_| Err(tobj::LoadError::MaterialParseError));
    let (models, _) = read.map_err(|error| match checked.problem.take() {
        Some(problem) => problem.in_file(file),
        None => MeshError::Reader {
            file: file.to_owned(),
            reason: error.to_string(),
        },
    })?;
    // Without groups and objects there is one model.
    let mesh = models.into_iter().next().map(|model| model.mesh);
    let mesh = mesh.unwrap_or_default();
    assemble(file, &mesh, contents, &checked.face_lines)
}

fn assemble(
    file: &str,
    mesh: &tobj::Mesh,
    contents: &Contents,
    face_lines: &[(u32, u32)],
) -> Result<ObjMesh, MeshError> {
    let positions: Vec<DVec3> = mesh.positions.chunks_exact(3).map(DVec3::from_slice).collect();
    let start = positions.first().copied().unwrap_or_default();
    let (low, high) = positions
        .iter()
        .fold((start, start), |(low, high), p| (low.min(*p), high.max(*p)));
    let origin = low * 0.5 + high * 0.5;
    let relative: Vec<DVec3> = positions.iter().map(|p| *p - origin).collect();
    let limit = f64::from(f32::MAX);
    if relative.iter().any(|p| p.abs().max_element() > limit * 0.5) {
        return Err(MeshError::TooWide {
            file: file.to_owned(),
            limit,
        });
    }
    let mut degenerate = Tally::default();
    let mut triangles = Vec::with_capacity(mesh.indices.len() / 3);
    let lines = face_lines
        .iter()
        .flat_map(|&(line, count)| std::iter::repeat_n(line, count as usize));
    for (corners, line) in mesh.indices.chunks_exact(3).zip(lines) {
        let [a, b, c] = [0, 1, 2].map(|corner| relative[corners[corner] as usize]);
        if has_area(a, b, c) {
            triangles.push([corners[0], corners[1], corners[2]]);
        } else {
            degenerate.add(line as usize);
        }
    }
    if triangles.is_empty() {
        return Err(MeshError::OnlyDegenerate {
            file: file.to_owned(),
            line: degenerate.first,
        });
    }
    let mut warnings = contents.warnings.clone();
    warnings.extend(degenerate.warning(Oddity::DegenerateTriangle));
    let normals = contents.use_normals.then(|| {
        let all = mesh.normals.chunks_exact(3).map(DVec3::from_slice);
        all.map(|normal| unit(normal).as_vec3()).collect()
    });
    let uvs = contents.use_uvs.then(|| {
        let all = mesh.texcoords.chunks_exact(2).map(DVec2::from_slice);
        all.map(|uv| uv.as_vec2()).collect()
    });
    Ok(ObjMesh {
        origin,
        positions: relative.iter().map(|p| p.as_vec3()).collect(),
        normals,
        uvs,
        triangles,
        warnings,
    })
}

/// Makes a normal that is not zero one long, however long it is.
fn unit(normal: DVec3) -> DVec3 {
    (normal / normal.abs().max_element()).normalize()
}

fn has_area(a: DVec3, b: DVec3, c: DVec3) -> bool {
    let [ab, ac] = [b - a, c - a];
    let longest = ab.abs().max_element().max(ac.abs().max_element());
    if longest == 0.0 {
        return false;
    }
    // Scaled first, so that nothing over- or underflows.
    let [ab, ac] = [ab / longest, ac / longest];
    let bc = ac - ab;
    let product = ab.length_squared().max(ac.length_squared()).max(bc.length_squared());
    ab.cross(ac).length() > LEAST_SINE * product
}

/// Reads as an OBJ file with checked lines only: positions, and normals and texture coordinates
/// if all faces have them, and faces with absolute indices.
struct Checked<'t> {
    lines: Lines<'t>,
    contents: &'t Contents,
    line: Vec<u8>,
    at: usize,
    seen: [usize; 3],
    /// For each face that was handed on its line, and how many triangles it makes.
    face_lines: Vec<(u32, u32)>,
    problem: Option<Problem>,
}

impl<'t> Checked<'t> {
    fn of(text: &'t str, contents: &'t Contents) -> Self {
        Self {
            lines: Lines::of(text),
            contents,
            line: Vec::new(),
            at: 0,
            seen: [0; 3],
            face_lines: Vec::with_capacity(contents.faces),
            problem: None,
        }
    }

    /// Gives the next line that `tobj` should see; empty at the end.
    fn next_line(&mut self) -> Result<String, Problem> {
        let mut checked = String::new();
        while let Some((line, text)) = self.lines.next() {
            let mut words = words(&text);
            let keyword = words.next();
            let written = match keyword {
                Some("v") => {
                    self.seen[0] += 1;
                    position(words).map(|[x, y, z]| writeln!(checked, "v {x:e} {y:e} {z:e}"))
                }
                Some("vt") => {
                    self.seen[1] += 1;
                    if !self.contents.use_uvs {
                        continue;
                    }
                    numbers(&mut words, 1).map(|[u, v]| writeln!(checked, "vt {u:e} {v:e}"))
                }
                Some("vn") => {
                    self.seen[2] += 1;
                    if !self.contents.use_normals {
                        continue;
                    }
                    numbers(&mut words, 3).map(|[x, y, z]| writeln!(checked, "vn {x:e} {y:e} {z:e}"))
                }
                Some("f") => {
                    let corners: Vec<&str> = words.collect();
                    if corners.len() < 3 {
                        continue;
                    }
                    self.face_lines.push((line as u32, corners.len() as u32 - 2));
                    self.face(&corners, &mut checked).map(|()| Ok(()))
                }
                _ => continue,
            };
            return match written {
                Ok(_) => Ok(checked),
                Err(problem) => Err(Problem { line, problem }),
            };
        }
        Ok(checked)
    }

    fn face(&self, corners: &[&str], checked: &mut String) -> Result<(), String> {
        checked.push('f');
        for corner in corners {
            if corner.split('/').count() > 3 {
                let corner = shorten(corner);
                return Err(format!("`{corner}` has more than three parts"));
            }
            let position = self.index(part(corner, 0), 0, "position")?;
            // Checked also where they are not used.
            let optional = |which: usize, what: &str| match part(corner, which) {
                "" => Ok(None),
                text => self.index(text, which, what).map(Some),
            };
            let uv = optional(1, "texture coordinate")?.filter(|_| self.contents.use_uvs);
            let normal = optional(2, "normal")?.filter(|_| self.contents.use_normals);
            let _ = match (uv, normal) {
                (None, None) => write!(checked, " {position}"),
                (Some(uv), None) => write!(checked, " {position}/{uv}"),
                (None, Some(normal)) => write!(checked, " {position}//{normal}"),
                (Some(uv), Some(normal)) => write!(checked, " {position}/{uv}/{normal}"),
            };
        }
        checked.push('\n');
        Ok(())
    }

    /// Makes an index absolute, from 1.
    fn index(&self, text: &str, which: usize, what: &str) -> Result<usize, String> {
        let total = [self.contents.positions, self.contents.uvs, self.contents.normals][which];
        let number: i64 = text
            .parse()
            .map_err(|_| format!("`{}` is not the number of a {what}", shorten(text)))?;
        let absolute = if number < 0 {
            number + self.seen[which] as i64 + 1
        } else {
            number
        };
        match usize::try_from(absolute) {
            Ok(0) if number == 0 => Err("numbers of vertices begin with 1, not 0".to_owned()),
            Ok(index) if (1..=total).contains(&index) => Ok(index),
            _ if number < 0 => Err(format!(
                "there is no {what} {number}: before this line there are {}",
                self.seen[which]
            )),
            _ => Err(format!("there is no {what} {number}, the file has {total}")),
        }
    }
}

impl Read for Checked<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let available = self.fill_buf()?;
        let count = available.len().min(buffer.len());
        buffer[..count].copy_from_slice(&available[..count]);
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Checked<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.at == self.line.len() {
            match self.next_line() {
                Ok(line) => {
                    self.line = line.into_bytes();
                    self.at = 0;
                }
                Err(problem) => {
                    self.problem = Some(problem);
                    return Err(io::Error::other("this line was refused"));
                }
            }
        }
        Ok(&self.line[self.at..])
    }

    fn consume(&mut self, count: usize) {
        self.at = (self.at + count).min(self.line.len());
    }
}
