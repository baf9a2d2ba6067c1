//! Tests of whole files and pictures.
