//! Lists that several opinions make together.

use std::collections::HashSet;
use std::hash::Hash;

use crate::diagnostic::Diagnostic;
use crate::layer::ListEdit;
use crate::source::Place;

/// So many items of each kind are kept for warnings.
const MOST_TROUBLES: usize = 20;

/// A list in the making, from the weakest opinion to the strongest.
pub(crate) struct Combined<T> {
    pub(crate) items: Vec<T>,
    /// Items of `delete` that were not there.
    idle_deletes: Vec<T>,
    /// Items that a stronger plain list replaces.
    dropped: Vec<T>,
}

impl<T> Default for Combined<T> {
    fn default() -> Self {
        Self {
            items: Vec::new(),
            idle_deletes: Vec::new(),
            dropped: Vec::new(),
        }
    }
}

/// What is odd about an edit of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EditTrouble {
    IdleDelete,
    Dropped,
}

impl EditTrouble {
    pub(crate) fn warning(self, name: &str) -> Diagnostic {
        match self {
            Self::IdleDelete => Diagnostic::warning(
                "delete-without-effect",
                format!("there is no `{name}` here to be deleted"),
            )
            .note("`delete` removes what weaker layers of the same file list, not what comes through an arc"),
            Self::Dropped => Diagnostic::warning(
                "list-drops-items",
                format!("a plain list in a stronger layer drops `{name}`"),
            )
            .note("a plain list replaces what is weaker; `Edit(prepend: ..)` adds to it"),
        }
    }
}

impl<T: Clone> Combined<T> {
    /// Applies an opinion that is stronger than those before; items with one `key` are one.
    pub(crate) fn add<K: Eq + Hash>(&mut self, edit: &ListEdit<T>, key: impl Fn(&T) -> K) {
        match edit {
            ListEdit::Explicit(items) if !items.is_empty() && !self.items.is_empty() => {
                let now: HashSet<K> = items.iter().map(&key).collect();
                let lost = self.items.iter().filter(|item| !now.contains(&key(item)));
                let room = MOST_TROUBLES.saturating_sub(self.dropped.len());
                self.dropped.extend(lost.take(room).cloned());
            }
            ListEdit::Edit { delete, .. } if !delete.is_empty() => {
                let before: HashSet<K> = self.items.iter().map(&key).collect();
                let idle = delete.iter().filter(|item| !before.contains(&key(item)));
                let room = MOST_TROUBLES.saturating_sub(self.idle_deletes.len());
                self.idle_deletes.extend(idle.take(room).cloned());
            }
            _ => {}
        }
        edit.apply(&mut self.items, &key);
    }

    /// Lists what deserves a warning, with its place.
    pub(crate) fn troubles(&self, place: impl Fn(&T) -> Place) -> Vec<(Place, EditTrouble)> {
        let idle = self
            .idle_deletes
            .iter()
            .map(|item| (place(item), EditTrouble::IdleDelete));
        let dropped = self.dropped.iter().map(|item| (place(item), EditTrouble::Dropped));
        idle.chain(dropped).collect()
    }
}
