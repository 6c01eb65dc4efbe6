use crate::profile::{Profile, TraceEvent, take_items};
use rustix::time::{ClockId, clock_gettime};
use std::cell::RefCell;
use std::time::{Duration, Instant};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;
use tracing_subscriber::registry::LookupSpan;

/// Listens to the span that bevy opens around every system and adds it to a [`Profile`].
///
/// It has to be installed as (part of) the global `tracing` subscriber before the schedules are built, since a system's
/// span is made with the system.
pub struct ProfileLayer {
    profile: Profile,
    origin: Instant,
}

impl ProfileLayer {
    /// A layer that writes to `profile`; its time starts now.
    #[must_use]
    pub fn new(profile: Profile) -> Self {
        Self {
            profile,
            origin: Instant::now(),
        }
    }
}

/// The name of a system, kept with its span.
struct SystemName(String);

#[derive(Default)]
struct NameVisitor(Option<String>);

impl Visit for NameVisitor {
    fn record_str(&mut self, field: &Field, value: &str) {
        if field.name() == "name" {
            self.0 = Some(value.into());
        }
    }

    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "name" {
            self.0 = Some(format!("{value:?}").trim_matches('"').into());
        }
    }
}

/// A system that runs at present, on this thread.
struct Running {
    start: Instant,
    cpu_start: Duration,
    inner_wall: Duration,
    inner_cpu: Duration,
    outer_items: u64,
}

thread_local! {
    static RUNNING: RefCell<Vec<Running>> = const { RefCell::new(Vec::new()) };
}

impl<S> Layer<S> for ProfileLayer
where
    S: tracing::Subscriber + for<'a> LookupSpan<'a>,
{
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        if attributes.metadata().name() == "system"
            && let Some(span) = context.span(id)
        {
            let mut visitor = NameVisitor::default();
            attributes.record(&mut visitor);
            if let Some(name) = visitor.0 {
                span.extensions_mut().insert(SystemName(name));
            }
        }
    }

    fn on_enter(&self, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        if span.extensions().get::<SystemName>().is_some() {
            let running = Running {
                outer_items: take_items(),
                start: Instant::now(),
                cpu_start: process_time(),
                inner_wall: Duration::ZERO,
                inner_cpu: Duration::ZERO,
            };
            RUNNING.with_borrow_mut(|stack| stack.push(running));
        }
    }

    fn on_exit(&self, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        let extensions = span.extensions();
        let Some(name) = extensions.get::<SystemName>() else {
            return;
        };
        let Some(running) = RUNNING.with_borrow_mut(Vec::pop) else {
            return;
        };
        let (wall, cpu) = (
            running.start.elapsed(),
            process_time().saturating_sub(running.cpu_start),
        );
        RUNNING.with_borrow_mut(|stack| {
            if let Some(outer) = stack.last_mut() {
                outer.inner_wall += wall;
                outer.inner_cpu += cpu;
            }
        });
        let event = TraceEvent {
            name: name.0.clone(),
            start: running.start.saturating_duration_since(self.origin),
            wall,
            items: take_items(),
        };
        crate::record_items(running.outer_items as usize);
        self.profile.add(
            event,
            wall.saturating_sub(running.inner_wall),
            cpu.saturating_sub(running.inner_cpu),
        );
    }
}

/// Processor time of this process so far, all threads.
fn process_time() -> Duration {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Duration::new(
        time.tv_sec.try_into().unwrap_or(0),
        time.tv_nsec.try_into().unwrap_or(0),
    )
}
