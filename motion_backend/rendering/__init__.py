"""Pictures of motions: a software renderer, cameras, contact sheets."""
