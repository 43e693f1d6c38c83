//! A frame -> spots: what is bright, what belongs together, where its centre is, and what is no marker.
