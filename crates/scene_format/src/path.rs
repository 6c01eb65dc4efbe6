//! Names of prims and paths made of them.

use crate::options::DEEPEST;

/// Why a name is not one.
pub(crate) fn name_problem(name: &str, longest: usize) -> Option<String> {
    if name.is_empty() {
        return Some("a name cannot be empty".to_owned());
    }
    if name.len() > longest {
        return Some(format!("a name has at most {longest} bytes, this one {}", name.len()));
    }
    let fine = |(at, c): (usize, char)| c == '_' || c.is_ascii_alphabetic() || (at > 0 && c.is_ascii_digit());
    if name.char_indices().all(fine) {
        return None;
    }
    Some(format!(
        "`{name}` is not a name; names are letters, digits and `_`, not beginning with a digit"
    ))
}

/// Why a text is not an absolute path.
pub(crate) fn absolute_path_problem(path: &str, longest: usize) -> Option<String> {
    let Some(names) = path.strip_prefix('/') else {
        return Some(format!("`{path}` is not an absolute path; paths begin with `/`"));
    };
    if names.split('/').count() > DEEPEST {
        return Some(too_deep());
    }
    names.split('/').find_map(|name| name_problem(name, longest))
}

fn too_deep() -> String {
    format!("a path has at most {DEEPEST} names")
}

/// Makes the path of a target absolute: `/A/B` stays, `../B`, `./B`, `B` and `.` begin at `owner`.
///
/// # Errors
///
/// In words, for a path that climbs above the root, or holds what is no name.
pub(crate) fn resolve_target(text: &str, owner: &str, longest: usize) -> Result<String, String> {
    if text.is_empty() {
        return Err("a path cannot be empty".to_owned());
    }
    if text.starts_with('/') {
        return match absolute_path_problem(text, longest) {
            Some(problem) => Err(problem),
            None => Ok(text.to_owned()),
        };
    }
    let mut names: Vec<&str> = owner.split('/').skip(1).collect();
    for part in text.split('/') {
        match part {
            "." => {}
            ".." => {
                if names.pop().is_none() {
                    return Err(format!("`{text}` climbs above the root of the scene"));
                }
            }
            name => match name_problem(name, longest) {
                Some(problem) => return Err(problem),
                None => names.push(name),
            },
        }
    }
    if names.len() > DEEPEST {
        return Err(too_deep());
    }
    if names.is_empty() {
        return Err(format!("`{text}` is the root of the scene, which is not a prim"));
    }
    Ok(format!("/{}", names.join("/")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolves_relative_targets() {
        let resolve = |text| resolve_target(text, "/World/Ring", 128);
        assert_eq!(resolve("../Looks/Gold").as_deref(), Ok("/World/Looks/Gold"));
        assert_eq!(resolve(".").as_deref(), Ok("/World/Ring"));
        assert_eq!(resolve("Stone").as_deref(), Ok("/World/Ring/Stone"));
        assert_eq!(resolve("/A/B").as_deref(), Ok("/A/B"));
        for bad in ["", "../../..", "../..", "/", "//A", "a b", "/A/"] {
            assert!(resolve(bad).is_err(), "{bad}");
        }
    }
}
