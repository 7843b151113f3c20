"""The scenes of gabion bench error, one module each."""
