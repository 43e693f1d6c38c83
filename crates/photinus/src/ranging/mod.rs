//! Spot size and marker pairs -> distance with bounds.
