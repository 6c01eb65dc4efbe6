use bevy_ecs::component::Component;
use bevy_ecs::resource::Resource;
use transport::PatchField;

/// A patch of radiosity: one side of a part of a matt surface, with its light. Written by `radiosity`; one entity each, by
/// the ten thousand; 72 bytes.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct RadiosityPatch(pub transport::Patch);

const _: () = assert!(size_of::<RadiosityPatch>() == 72);

/// Whether a stage beside `radiosity` wants its patches. Written while stages plan, before `radiosity` does.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct PatchDemand(pub bool);

/// The patches with their light, and how to find them. Written by `radiosity`; present once it is solved.
#[derive(Resource, Clone, Debug)]
pub struct SolvedPatches(pub PatchField);
