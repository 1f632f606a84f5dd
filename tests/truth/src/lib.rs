//! An independent plant that makes concealed cases; shares no code with the diagnosis it examines.
