//! Photos and recordings in; cameras, spot-size curves, mountings and LED layouts out, each with its uncertainty.
