example_folder(recipes)

# Each compares its own results with theory.
foreach(name distance_free_energy minimise barostats replicas cells respa)
    example_test(recipes.${name} recipes recipe_${name} --)
endforeach()
