//! Light tables, photon and path steps, density estimates.
