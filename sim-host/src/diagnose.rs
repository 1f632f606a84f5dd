//! Where a model and recordings part, and what physics was left out.
