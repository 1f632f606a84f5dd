//! Models of the table, and the effects a model may be missing.
