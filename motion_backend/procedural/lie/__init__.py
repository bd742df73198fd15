"""Lying down and getting up."""
