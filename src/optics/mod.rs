//! Interfaces, films, materials and microfacets. Knows nothing of what is above it.
