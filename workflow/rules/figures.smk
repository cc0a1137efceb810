"""Figures of a category, each a picture with the data behind it beside it.

Inputs: folders of samples, trained models, the fields and repaired meshes. Outputs: under <results>/figures;
the interpolated and summed meshes under <results>/latent, the nearest training shapes under <results>/nearest.
"""

# Shapes of the models that a few figures show, as solids; and of those of the table, all in the first mode.
SHOWN_SAMPLES = each_mode(
    "<results>/samples/{{category}}/{model}/{seed}/{mode}",
    FIGURE_MODELS,
    modes=SETTINGS.shown_mode,
    seeds=config["seeds"][:1],
)
TABLE_SAMPLES = expand(
    "<results>/samples/{{category}}/{model}/{seed}/{mode}",
    model=SETTINGS.table_models,
    seed=config["seeds"][:1],
    mode=config["modes"][0],
)
FIGURES = expand(
    "<results>/figures/{category}/{figure}.png",
    category=config["categories"],
    figure=[
        *("samples", "comparison", "interpolation", "arithmetic"),
        *("solids", "nearest", "training"),
    ],
)

PAPER_TARGETS += FIGURES


rule interpolate_shapes:
    input:
        unpack(model_fields),
        unpack(trained_model),
    output:
        meshes=directory("<results>/latent/{category}/{model}/{seed}/interpolation"),
    log:
        "<logs>/interpolate_shapes/{category}/{model}/{seed}.log",
    benchmark:
        "<benchmarks>/interpolate_shapes/{category}/{model}/{seed}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        latent=section("latent"),
        meshing=meshing_options,
        code=code_digest(
            "tetgan.studies.latent.interpolation:interpolate_shapes", of_model=True
        ),
    shell:
        "tetgan interpolate {params.model:q} {input.index:q} {output.meshes:q}"
        " --options {params.latent:q} --meshing {params.meshing:q} >{log:q} 2>&1"


rule add_parts:
    input:
        unpack(model_fields),
        unpack(trained_model),
    output:
        meshes=directory("<results>/latent/{category}/{model}/{seed}/arithmetic"),
    log:
        "<logs>/add_parts/{category}/{model}/{seed}.log",
    benchmark:
        "<benchmarks>/add_parts/{category}/{model}/{seed}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        model=subpath(input.weights, parent=True),
        latent=section("latent"),
        meshing=meshing_options,
        code=code_digest("tetgan.studies.latent.arithmetic:add_parts", of_model=True),
    shell:
        "tetgan add-parts {params.model:q} {input.index:q} {output.meshes:q}"
        " --options {params.latent:q} --meshing {params.meshing:q} >{log:q} 2>&1"


rule find_nearest:
    input:
        samples="<results>/samples/{category}/{model}/{seed}/{mode}",
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        catalogue="<results>/data/{category}/catalogue.csv",
    output:
        table="<results>/nearest/{category}/{model}/{seed}/{mode}.csv",
    log:
        "<logs>/find_nearest/{category}/{model}/{seed}/{mode}.log",
    benchmark:
        "<benchmarks>/find_nearest/{category}/{model}/{seed}/{mode}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        options=section("nearest"),
        code=code_digest("tetgan.studies.latent.nearest:find_nearest_shapes"),
    shell:
        "tetgan find-nearest {input.meshes:q} {output.table:q} --catalogue {input.catalogue:q}"
        " --samples {input.samples:q} --options {params.options:q} --threads {threads} >{log:q} 2>&1"


rule find_nearest_real:
    input:
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
        catalogue="<results>/data/{category}/catalogue.csv",
    output:
        table="<results>/nearest/{category}/real.csv",
    log:
        "<logs>/find_nearest_real/{category}.log",
    benchmark:
        "<benchmarks>/find_nearest_real/{category}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=3000,
    params:
        options=section("nearest"),
        code=code_digest("tetgan.studies.latent.nearest:find_nearest_shapes"),
    shell:
        "tetgan find-nearest {input.meshes:q} {output.table:q} --catalogue {input.catalogue:q}"
        " --options {params.options:q} --threads {threads} >{log:q} 2>&1"


rule draw:
    """What all rules of figures share. It draws nothing itself: no figure has the name that it asks for."""
    output:
        picture="<results>/figures/{category}/{figure}.png",
        data="<results>/figures/{category}/{figure}.csv",
    log:
        "<logs>/draw/{category}/{figure}.log",
    wildcard_constraints:
        figure=one_of([]),
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=1500,
    params:
        names=FIGURE_MODELS,
    script:
        "../scripts/draw.py"


use rule draw as draw_samples with:
    input:
        samples=SHOWN_SAMPLES,
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        **figure("samples"),
    log:
        "<logs>/draw_samples/{category}.log",
    params:
        figure="samples",
        columns=config["figures"]["columns"],
        code=code_digest("draw_samples.py"),


use rule draw as draw_comparison with:
    input:
        samples=TABLE_SAMPLES,
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        **figure("comparison"),
    log:
        "<logs>/draw_comparison/{category}.log",
    params:
        figure="comparison",
        names=SETTINGS.table_models,
        columns=config["figures"]["columns"],
        code=code_digest("draw_comparison.py"),


use rule draw as draw_solids with:
    input:
        samples=SHOWN_SAMPLES,
    output:
        **figure("solids"),
    log:
        "<logs>/draw_solids/{category}.log",
    params:
        figure="solids",
        code=code_digest("draw_solids.py"),


use rule draw as draw_interpolation with:
    input:
        folders=expand(
            "<results>/latent/{{category}}/{model}/{seed}/interpolation",
            model=FIGURE_MODELS,
            seed=config["seeds"][:1],
        ),
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        **figure("interpolation"),
    log:
        "<logs>/draw_interpolation/{category}.log",
    params:
        figure="interpolation",
        code=code_digest("draw_interpolation.py"),


use rule draw as draw_arithmetic with:
    input:
        folders=expand(
            "<results>/latent/{{category}}/{model}/{seed}/arithmetic",
            model=FIGURE_MODELS,
            seed=config["seeds"][:1],
        ),
    output:
        **figure("arithmetic"),
    log:
        "<logs>/draw_arithmetic/{category}.log",
    params:
        figure="arithmetic",
        code=code_digest("draw_arithmetic.py"),


use rule draw as draw_nearest with:
    input:
        samples=SHOWN_SAMPLES,
        tables=each_mode(
            "<results>/nearest/{{category}}/{model}/{seed}/{mode}.csv",
            FIGURE_MODELS,
            modes=SETTINGS.shown_mode,
            seeds=config["seeds"][:1],
        ),
        real="<results>/nearest/{category}/real.csv",
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        **figure("nearest", "nearest training shape"),
    log:
        "<logs>/draw_nearest/{category}.log",
    params:
        figure="nearest",
        columns=config["figures"]["columns"],
        code=code_digest("draw_nearest.py"),


use rule draw as draw_training with:
    input:
        weights=expand(
            "<results>/models/{{category}}/{model}/{seed}/weights.safetensors",
            model=LOGGED_MODELS,
            seed=config["seeds"],
        ),
    output:
        **figure("training"),
    log:
        "<logs>/draw_training/{category}.log",
    resources:
        mem_mb=500,
    params:
        figure="training",
        names=[name for name in LOGGED_MODELS for _ in config["seeds"]],
        seeds=[seed for _ in LOGGED_MODELS for seed in config["seeds"]],
        code=code_digest("draw_training.py"),


if config["ablation"]:
    PAPER_TARGETS += expand(
        "<results>/figures/{category}/ablation-training.png",
        category=config["categories"][:1],
    )

    use rule draw_training as draw_ablation_training with:
        input:
            weights=expand(
                "<results>/models/{{category}}/{model}/{seed}/weights.safetensors",
                model=ABLATED_MODELS,
                seed=config["seeds"],
            ),
        output:
            **figure("ablation-training", "training of the ablation"),
        log:
            "<logs>/draw_ablation_training/{category}.log",
        params:
            names=[name for name in ABLATED_MODELS for _ in config["seeds"]],
            seeds=[seed for _ in ABLATED_MODELS for seed in config["seeds"]],


rule figures:
    input:
        FIGURES,
