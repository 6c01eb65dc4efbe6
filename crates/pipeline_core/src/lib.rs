//! The application, its schedules, profiler and cancellation.
