"""Small bugs put into copies of the tree, one at a time: which share of them do the tests see?"""
