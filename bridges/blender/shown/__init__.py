"""What a render shows, and the scene reduced to it.

    rendered          what Cycles would be given
    shown_scene       a scene of just that, for the exporter
    as_rendered       the scene itself as it is rendered, where it has to move or to be baked
    real_meshes       what is baked: instances made real
"""
