//! Paths as small numbers: prims, and variants of prims, of all layers of a scene.

use std::collections::HashMap;

/// Number of a word: a prim's name, a set of variants, a variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Word(u32);

/// Number of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct PathId(u32);

impl PathId {
    /// The path `/`, which is no prim but the parent of all top-level ones.
    pub(crate) const ROOT: Self = Self(0);
}

/// The last step of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Step {
    /// Of `/` itself.
    Root,
    /// To a child.
    Child(Word),
    /// Into the body of a variant: no deeper in the scene, but another place in the file.
    Variant { set: Word, variant: Word },
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    parent: PathId,
    step: Step,
    /// Steps to children.
    depth: u16,
    /// All steps.
    steps: u16,
    in_variant: bool,
}

/// Every path that was ever named, each once.
#[derive(Debug)]
pub(crate) struct PathTable {
    entries: Vec<Entry>,
    numbers: HashMap<(PathId, Step), PathId>,
    words: Vec<Box<str>>,
    word_numbers: HashMap<Box<str>, Word>,
}

impl Default for PathTable {
    fn default() -> Self {
        let root = Entry {
            parent: PathId::ROOT,
            step: Step::Root,
            depth: 0,
            steps: 0,
            in_variant: false,
        };
        Self {
            entries: vec![root],
            numbers: HashMap::new(),
            words: Vec::new(),
            word_numbers: HashMap::new(),
        }
    }
}

impl PathTable {
    fn entry(&self, path: PathId) -> &Entry {
        &self.entries[path.0 as usize]
    }

    /// Gives the number of a word.
    pub(crate) fn word(&mut self, text: &str) -> Word {
        if let Some(&word) = self.word_numbers.get(text) {
            return word;
        }
        let word = Word(self.words.len() as u32);
        self.words.push(text.into());
        self.word_numbers.insert(text.into(), word);
        word
    }

    pub(crate) fn word_text(&self, word: Word) -> &str {
        &self.words[word.0 as usize]
    }

    /// Goes one step on.
    pub(crate) fn join(&mut self, parent: PathId, step: Step) -> PathId {
        if let Some(&path) = self.numbers.get(&(parent, step)) {
            return path;
        }
        let path = PathId(self.entries.len() as u32);
        let above = *self.entry(parent);
        let is_child = matches!(step, Step::Child(_));
        self.entries.push(Entry {
            parent,
            step,
            depth: above.depth.saturating_add(u16::from(is_child)),
            steps: above.steps.saturating_add(1),
            in_variant: above.in_variant || !is_child,
        });
        self.numbers.insert((parent, step), path);
        path
    }

    pub(crate) fn child(&mut self, parent: PathId, name: Word) -> PathId {
        self.join(parent, Step::Child(name))
    }

    /// Gives the number of an absolute path without variants, whose names are fine.
    pub(crate) fn intern(&mut self, text: &str) -> PathId {
        text.split('/')
            .filter(|name| !name.is_empty())
            .fold(PathId::ROOT, |path, name| {
                let name = self.word(name);
                self.child(path, name)
            })
    }

    pub(crate) fn parent(&self, path: PathId) -> PathId {
        self.entry(path).parent
    }

    pub(crate) fn step(&self, path: PathId) -> Step {
        self.entry(path).step
    }

    /// Counts the names in a path; variants do not count.
    pub(crate) fn depth(&self, path: PathId) -> u16 {
        self.entry(path).depth
    }

    pub(crate) fn is_in_variant(&self, path: PathId) -> bool {
        self.entry(path).in_variant
    }

    /// Whether a path is `/Name`.
    pub(crate) fn is_top_level_prim(&self, path: PathId) -> bool {
        let entry = self.entry(path);
        entry.parent == PathId::ROOT && matches!(entry.step, Step::Child(_))
    }

    /// Whether a path is `prefix` or lies below it.
    pub(crate) fn has_prefix(&self, mut path: PathId, prefix: PathId) -> bool {
        let steps = self.entry(prefix).steps;
        while self.entry(path).steps > steps {
            path = self.parent(path);
        }
        path == prefix
    }

    /// Counts all steps, those into variants too.
    pub(crate) fn steps(&self, path: PathId) -> u16 {
        self.entry(path).steps
    }

    /// Puts `to` in the place of the beginning `from` of a path; leaves other paths as they are.
    pub(crate) fn replace_prefix(&mut self, path: PathId, from: PathId, to: PathId) -> PathId {
        if path == from {
            return to;
        }
        if from == to || !self.has_prefix(path, from) {
            return path;
        }
        let Entry { parent, step, .. } = *self.entry(path);
        let parent = self.replace_prefix(parent, from, to);
        self.join(parent, step)
    }

    /// Gives the prim that a path in a file means: the path without variants.
    pub(crate) fn without_variants(&mut self, path: PathId) -> PathId {
        if !self.is_in_variant(path) {
            return path;
        }
        let Entry { parent, step, .. } = *self.entry(path);
        let parent = self.without_variants(parent);
        match step {
            Step::Child(name) => self.child(parent, name),
            _ => parent,
        }
    }

    /// Drops the variants at the end of a path.
    pub(crate) fn without_last_variants(&self, mut path: PathId) -> PathId {
        while matches!(self.step(path), Step::Variant { .. }) {
            path = self.parent(path);
        }
        path
    }

    /// Climbs `levels` names; variants at the end of what is left are dropped on the way only.
    pub(crate) fn ancestor(&self, mut path: PathId, levels: u16) -> PathId {
        for _ in 0..levels {
            path = self.parent(self.without_last_variants(path));
        }
        path
    }

    /// Gives the last name.
    pub(crate) fn name(&self, path: PathId) -> Option<Word> {
        match self.step(self.without_last_variants(path)) {
            Step::Child(name) => Some(name),
            _ => None,
        }
    }

    /// Writes a path: `/World/Ring`, `/World/Ring{metal=gold}Stone`.
    pub(crate) fn text(&self, path: PathId) -> String {
        let mut steps = Vec::with_capacity(self.entry(path).steps as usize);
        let mut at = path;
        while at != PathId::ROOT {
            steps.push(self.step(at));
            at = self.parent(at);
        }
        if steps.is_empty() {
            return "/".to_owned();
        }
        let mut text = String::new();
        let mut after_variant = false;
        for step in steps.into_iter().rev() {
            match step {
                Step::Child(name) => {
                    if !after_variant {
                        text.push('/');
                    }
                    text.push_str(self.word_text(name));
                    after_variant = false;
                }
                Step::Variant { set, variant } => {
                    text.push_str(&format!("{{{}={}}}", self.word_text(set), self.word_text(variant)));
                    after_variant = true;
                }
                Step::Root => {}
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_into_variants_are_no_names() {
        let mut paths = PathTable::default();
        let ring = paths.intern("/World/Ring");
        let (set, variant, stone) = (paths.word("metal"), paths.word("gold"), paths.word("Stone"));
        let gold = paths.join(ring, Step::Variant { set, variant });
        let inside = paths.child(gold, stone);
        assert_eq!(paths.text(inside), "/World/Ring{metal=gold}Stone");
        assert_eq!(paths.depth(inside), 3);
        let plain = paths.without_variants(inside);
        assert_eq!(paths.text(plain), "/World/Ring/Stone");
        assert_eq!(paths.replace_prefix(plain, ring, gold), inside);
        assert_eq!(paths.ancestor(inside, 1), gold);
        assert_eq!(paths.text(paths.ancestor(inside, 2)), "/World");
        assert!(paths.has_prefix(inside, ring) && !paths.has_prefix(ring, inside));
    }
}
